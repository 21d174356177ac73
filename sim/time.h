#pragma once
#include <bit>
#include <cassert>
#include <cstdint>
#include <limits>

namespace sim {

/// A point in simulated time or a duration, in integer femtoseconds: exact for every clock.
using Time = std::uint64_t;

/// The latest time, which means "never": the largest value that is also a signed 64-bit number.
inline constexpr Time kNever = std::numeric_limits<std::int64_t>::max();
inline constexpr Time kFemtosecondsPerNanosecond = 1'000'000;
inline constexpr Time kFemtosecondsPerSecond = 1'000'000'000'000'000;

/// A clock domain, with edges at all multiples of the period from time 0.
class Clock {
 public:
  constexpr explicit Clock(Time period)
      : period_(period),
        shift_(static_cast<unsigned>(std::bit_width(period - 1))),
        inverse_(static_cast<Time>(((Wide{1} << (kTimeBits + shift_)) + period - 1) / period)) {
    assert(period > 0);
  }

  constexpr Time period() const { return period_; }
  constexpr Time edge_at_or_after(Time t) const { return cycles(t + period_ - 1) * period_; }
  constexpr bool is_edge(Time t) const { return cycles(t) * period_ == t; }
  /// Returns the time of the clock edge that is `cycles` cycles after `now`, which must be an edge.
  constexpr Time edge_after(Time now, std::uint64_t cycles) const { return now + cycles * period_; }
  /// Returns the number of whole cycles in time `t`, which must be below 2^kTimeBits femtoseconds (over an hour).
  constexpr std::uint64_t cycles(Time t) const {
    assert(t >> kTimeBits == 0);
    return static_cast<std::uint64_t>((Wide{t} * inverse_) >> (kTimeBits + shift_));
  }

  friend constexpr bool operator==(const Clock& a, const Clock& b) { return a.period_ == b.period_; }

 private:
  // Divides by multiplying with 2^(kTimeBits + shift) / period, rounded up. This is exact for operands of kTimeBits
  // bits (Granlund and Montgomery 1994, theorem 4.2).
  __extension__ using Wide = unsigned __int128;
  static constexpr unsigned kTimeBits = 62;

  Time period_;
  unsigned shift_;
  Time inverse_;
};

}  // namespace sim
