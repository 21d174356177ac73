#pragma once
#include <string>

#include "traces/scene/limits.h"
#include "traces/scene/scene.h"

namespace traces {

/// What a user may call a scene. With a '/' or the extension .glb or .gltf it is a file; otherwise the name of a
/// built-in scene, or of a file NAME.glb or NAME.gltf in one of the folders of $RAYWATT_PATH (or its `scenes` folder).
/// InputError with the nearest name if there is none.
Scene open_scene(const std::string& name_or_path, const SceneLimits& limits = {});

}  // namespace traces
