#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// Name and description of a scene that the program can generate, so that nothing must be downloaded.
struct BuiltinInfo {
  std::string name;
  std::string description;      ///< one line of text
  std::uint32_t triangles = 0;  ///< number of triangles of the scene in the literature that it resembles
};

/// Options with which a built-in scene is generated.
struct BuiltinOptions {
  std::uint32_t triangles = 0;  ///< approximate number of triangles; 0: BuiltinInfo::triangles
  std::uint32_t triangles_or_default(std::uint32_t of_class) const { return triangles == 0 ? of_class : triangles; }
};

std::vector<BuiltinInfo> builtin_scenes();
/// Throws InputError, with the nearest name, unless a scene called `name` is built in.
void check_builtin_name(std::string_view name);

/// Generates the built-in scene called `name`. Throws InputError with the nearest name if there is none.
Scene build_scene(std::string_view name, const BuiltinOptions& options = {});

Scene build_atrium(const BuiltinOptions& options);
Scene build_bathroom(const BuiltinOptions& options);
Scene build_car(const BuiltinOptions& options);
Scene build_chess(const BuiltinOptions& options);
Scene build_conference(const BuiltinOptions& options);
Scene build_cornell(const BuiltinOptions& options);
Scene build_crowd(const BuiltinOptions& options);
Scene build_forest(const BuiltinOptions& options);
Scene build_hairball(const BuiltinOptions& options);
Scene build_laboratory(const BuiltinOptions& options);
Scene build_teapot(const BuiltinOptions& options);
Scene build_village(const BuiltinOptions& options);

}  // namespace traces
