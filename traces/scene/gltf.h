#pragma once
#include <filesystem>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

/// Reads a glTF 2.0 file (.gltf or .glb, told apart by their first bytes): the default scene's nodes with their
/// triangles, materials, lights and perspective cameras, its skins, morph targets and animations, posed at time 0. What
/// cannot be shown as the file says is told in Scene::warnings; what cannot be read is an InputError of one line.
///
/// Files named by the .gltf must lie in its folder or below; nothing is read over a network. Rules of their own have:
/// surfaces (gltf/materials/materials.h), lights and exposure (lights.h), a file without cameras (framing_camera), a
/// file without lights (add_default_light).
Scene load_gltf(const std::filesystem::path& path, const SceneLimits& limits = {});

}  // namespace traces
