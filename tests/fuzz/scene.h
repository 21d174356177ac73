#pragma once
#include "tests/fuzz/common.h"
#include "traces/scene/gltf.h"

namespace fuzz {

/// Returns low limits of scene size, so that files that exceed them are refused quickly.
inline traces::SceneLimits small_limits() {
  traces::SceneLimits limits;
  limits.memory.bytes = std::uint64_t{1} << 26;
  limits.pixels = 1U << 16;
  limits.nodes = 1000;
  return limits;
}

inline void load_scene(std::string_view bytes, const std::string& name) {
  const std::filesystem::path file = file_of(bytes, name);
  ignore_input_errors([&] { traces::load_gltf(file, small_limits()); });
}

}  // namespace fuzz
