#pragma once
#include <filesystem>
#include <string>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"

namespace traces {

/// Is this a file, not a name? It is if it has a '/' or the extension .glb or .gltf.
bool is_scene_file(const std::string& text);

/// Name that a user may give a scene. A file, or else the name of a
/// built-in scene, or of a file NAME.glb or NAME.gltf in one of the folders of $RAYWATT_PATH (or its `scenes` folder).
/// InputError with the nearest name if there is none.
Scene open_scene(const std::string& name_or_path, const BuiltinOptions& options = {}, const SceneLimits& limits = {});

/// The file that open_scene() reads for that name; empty for a built-in scene and for names that are not known.
std::filesystem::path scene_file(const std::string& name_or_path);

}  // namespace traces
