#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// The bytes of a self-contained GLB file (glTF 2.0) that shows the scene at rest and moving. load_gltf() reads the
/// same picture from it, and any other program what glTF can say of it: meshes with all their attributes, nodes and
/// tracks, skins, morph targets, textures as PNG, lights and cameras. Equal scenes give equal bytes.
///
/// Rules of their own have surfaces (gltf_export/materials.h) and the light (gltf_export/lights.h). Meshes without
/// triangles are left out. InputError if the file would be larger than GLB allows, 4 GiB.
std::string export_glb(const Scene& scene);

}  // namespace traces
