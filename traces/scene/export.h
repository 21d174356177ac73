#pragma once
#include <string>

#include "traces/scene/scene.h"

namespace traces {

/// Returns the bytes of a self-contained GLB file (glTF 2.0) that contains the scene in its rest pose, and its
/// animation.
///
/// 1. A scene that load_gltf() reads back gives the same picture. Other programs see what glTF can express: meshes with
/// all attributes, nodes, tracks, skins, morph targets, textures as PNG, lights, cameras.
/// 2. Equal scenes give equal bytes.
/// 3. Meshes without triangles are omitted.
/// 4. Surfaces are written as gltf_export/materials.h describes, lights as gltf_export/nodes.h does.
///
/// Throws InputError if the file would exceed GLB's limit of 4 GiB.
std::string export_glb(const Scene& scene);

}  // namespace traces
