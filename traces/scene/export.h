#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Returns the scene, at rest and with its motion, as the bytes of a self-contained GLB file (glTF 2.0).
///
/// 1. load_gltf() reads the same picture back. Other programs see what glTF can express: meshes with all attributes,
///    nodes, tracks, skins, morph targets, textures as PNG, lights, cameras.
/// 2. Equal scenes give equal bytes.
/// 3. Meshes without triangles are left out.
/// 4. Surfaces follow gltf_export/materials.h, light follows gltf_export/lights.h.
///
/// Throws InputError if the file would exceed GLB's limit of 4 GiB.
std::string export_glb(const Scene& scene);

}  // namespace traces
