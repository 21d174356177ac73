#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// A scene that the program makes itself, so that nothing needs downloading.
struct BuiltinInfo {
  std::string name;
  std::string description;  ///< one line
};

std::vector<BuiltinInfo> builtin_scenes();

/// The scene of that name. InputError, with the nearest name, if there is none.
Scene build_scene(std::string_view name);

Scene build_cornell();
Scene build_teapot();

}  // namespace traces
