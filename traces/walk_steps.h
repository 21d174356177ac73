#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "traces/walk.h"

namespace traces {

/// Counts of canonical traversal steps: nodes visited and triangles tested.
struct WalkSteps {
  std::uint64_t visits = 0, tests = 0;
  std::uint64_t enters = 0;  ///< instances entered (not counted as steps)
  std::uint64_t all() const { return visits + tests; }
  WalkSteps& operator+=(const WalkSteps& other) {
    visits += other.visits;
    tests += other.tests;
    enters += other.enters;
    return *this;
  }
};

/// Returns the number of steps in concatenated walks.
inline WalkSteps count_steps(std::span<const std::uint32_t> words) {
  WalkSteps steps;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (kind_of(words[i]) == StepKind::kVisit) {
      steps.visits += 1;
    } else if (is_enter(words[i])) {
      steps.enters += 1;
    } else if (kind_of(words[i]) == StepKind::kLeaf) {
      steps.tests += count_of(words[i++]);  // skips the word of exit phases
    }
  }
  return steps;
}

}  // namespace traces
