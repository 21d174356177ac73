#pragma once
#include <cstdint>

namespace sim {

/// Rule for what a counter becomes when another stretch of time is added to it.
enum class CounterKind : std::uint8_t {
  kSum,    ///< adds up
  kPeak,   ///< the most so far: the larger of two
  kAtEnd,  ///< adds up, but is made up only when the run is over
};

}  // namespace sim
