#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "traces/scene/scene.h"

namespace traces {

/// A scene that the program generates, so that nothing must be downloaded.
struct BuiltinInfo {
  std::string name;
  std::string description;      ///< one line
  std::uint32_t triangles = 0;  ///< triangles of its class in the literature
};

/// Options of a generator.
struct BuiltinOptions {
  std::uint32_t triangles = 0;  ///< approximate number; 0: that of its class
  std::uint32_t triangles_or(std::uint32_t of_class) const { return triangles == 0 ? of_class : triangles; }
};

std::vector<BuiltinInfo> builtin_scenes();
/// Throws InputError with the nearest name unless a scene of this name is built in.
void check_builtin_name(std::string_view name);

/// Generates the scene of that name. Throws InputError with the nearest name if there is none.
Scene build_scene(std::string_view name, const BuiltinOptions& options = {});

Scene build_atrium(const BuiltinOptions& options);
Scene build_bathroom(const BuiltinOptions& options);
Scene build_car(const BuiltinOptions& options);
Scene build_chess(const BuiltinOptions& options);
Scene build_conference(const BuiltinOptions& options);
Scene build_cornell(const BuiltinOptions& options);
Scene build_forest(const BuiltinOptions& options);
Scene build_hairball(const BuiltinOptions& options);
Scene build_laboratory(const BuiltinOptions& options);
Scene build_teapot(const BuiltinOptions& options);
Scene build_village(const BuiltinOptions& options);

}  // namespace traces
