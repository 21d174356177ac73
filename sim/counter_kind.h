#pragma once
#include <cstdint>

namespace sim {

/// How a counter is combined when two time spans are added.
enum class CounterKind : std::uint8_t {
  kSum,    ///< values add
  kPeak,   ///< the larger value
  kAtEnd,  ///< values add, but the counter is filled in only at the end of the run
};

}  // namespace sim
