#pragma once
#include <filesystem>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

/// Reads a glTF 2.0 file. Its first bytes determine whether it is a .gltf or a .glb file.
///
/// 1. It reads the default scene's nodes with their triangles, materials, lights, perspective cameras, skins, morph
/// targets and animations, posed at time 0.
/// 2. Content that cannot be shown as the file specifies adds a line to Scene::warnings. Throws InputError for content
/// that cannot be read.
/// 3. Files to which the .gltf file refers must be in its folder or below; nothing is read over a network.
/// 4. Surfaces are converted as gltf/materials.h describes, lights and exposure as lights.h does. A file without
/// cameras gets framing_camera(), one without lights add_default_light().
Scene load_gltf(const std::filesystem::path& path, const SceneLimits& limits = {});

}  // namespace traces
