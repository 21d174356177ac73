#pragma once
#include <algorithm>
#include <cstdint>

namespace hw {

/// Displacement of a channel's times that makes no other design of it (docs/noise.md). None by default.
struct DramShift {
  std::int32_t fabric = 0;    ///< cycles of the command clock by which reads take longer; never below none at all
  std::uint32_t refresh = 0;  ///< cycles by which every refresh comes earlier, taken modulo their interval

  std::uint64_t moved_fabric(std::uint64_t cycles) const {
    return static_cast<std::uint64_t>(std::max(std::int64_t{0}, static_cast<std::int64_t>(cycles) + fabric));
  }
  std::uint64_t first_refresh(std::uint64_t interval) const { return interval - refresh % interval; }
};

}  // namespace hw
