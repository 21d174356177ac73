#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "traces/walk.h"

namespace traces {

/// Canonical traversal steps of whole walks, back to back: nodes visited and triangles tested.
inline std::uint64_t count_steps(std::span<const std::uint32_t> words) {
  std::uint64_t steps = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (kind_of(words[i]) == StepKind::kVisit) {
      steps += 1;
    } else if (kind_of(words[i]) == StepKind::kLeaf && !is_enter(words[i])) {
      steps += count_of(words[i++]);  // its exit phases follow
    }
  }
  return steps;
}

}  // namespace traces
