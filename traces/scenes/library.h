#pragma once
#include <filesystem>
#include <string>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"

namespace traces {

/// True if `text` is the name of a file: it contains '/' or ends with .glb or .gltf.
bool is_scene_file(const std::string& text);

/// Opens the scene that a user names: a file, a built-in scene, or a file NAME.glb or NAME.gltf in a folder of
/// $RAYWATT_PATH (or its `scenes` folder). Throws InputError with the nearest name if there is none.
Scene open_scene(const std::string& name_or_path, const BuiltinOptions& options = {}, const SceneLimits& limits = {});

/// Returns the file that open_scene() reads for a name; empty for a built-in scene or an unknown name.
std::filesystem::path scene_file(const std::string& name_or_path);

}  // namespace traces
