#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace sim {

/// Returns the index of the smallest of `count` (at least one) numbers, the first of equals. Branch-free: the outcome
/// is unpredictable.
inline std::uint32_t index_of_least(const std::uint32_t* numbers, std::size_t count) {
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t i = 0; i < count; ++i) least = std::min(least, std::uint64_t{numbers[i]} << 32 | i);
  return static_cast<std::uint32_t>(least);
}

}  // namespace sim
