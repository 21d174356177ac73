#pragma once
#include "traces/scene/gltf_export/document.h"

namespace traces::gltf_export {

/// Writes Scene::textures one to one; equal texels share one PNG, equal wrap modes and filters one sampler.
void write_textures(const Scene& scene, Document& out);

}  // namespace traces::gltf_export
