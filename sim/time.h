#pragma once
#include <cassert>
#include <cstdint>
#include <limits>

namespace sim {

/// A moment or a span, in integer femtoseconds: fine enough for every clock, and never rounded by arithmetic.
using Time = std::uint64_t;

inline constexpr Time kNever = std::numeric_limits<Time>::max();
inline constexpr Time kFemtosecondsPerSecond = 1'000'000'000'000'000;

/// A clock domain: edges at every multiple of the period, starting at time 0.
class Clock {
 public:
  constexpr explicit Clock(Time period) : period_(period) { assert(period > 0); }

  constexpr Time period() const { return period_; }
  constexpr Time edge_at_or_after(Time t) const { return (t + period_ - 1) / period_ * period_; }
  constexpr bool is_edge(Time t) const { return t % period_ == 0; }
  /// The edge `cycles` after `now`, which must itself be an edge.
  constexpr Time after(Time now, std::uint64_t cycles) const { return now + cycles * period_; }
  /// Whole cycles that fit into `t`.
  constexpr std::uint64_t cycles(Time t) const { return t / period_; }

  friend constexpr bool operator==(const Clock&, const Clock&) = default;

 private:
  Time period_;
};

}  // namespace sim
