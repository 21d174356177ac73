#include "traces/scene/gltf/context.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"

namespace traces::gltf {

void Context::refuse(const std::string& why) const { throw sim::InputError(file + ": " + why); }

void Context::warn(const std::string& what) {
  constexpr std::size_t kMost = 50;
  if (scene.warnings.size() >= kMost || std::ranges::find(scene.warnings, what) != scene.warnings.end()) return;
  scene.warnings.push_back(scene.warnings.size() + 1 < kMost ? what : "further warnings are left out");
}

void Context::refuse_index(const char* what, long long index, std::size_t size) const {
  if (size == 0) refuse(fmt::format("{}[{}] is referred to, but the file has none", what, index));
  refuse(fmt::format("{}[{}] is referred to; allowed are 0 to {}", what, index, size - 1));
}

}  // namespace traces::gltf
