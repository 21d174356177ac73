#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "sim/time.h"

namespace hw {

/// A cycle of a clock: its edge, the next one, and its number.
struct Cycle {
  sim::Time now, next;
  std::uint64_t number;

  Cycle(sim::Time at, const sim::Clock& clock) : now(at), next(clock.after(at, 1)), number(clock.cycles(at)) {}
  /// To a later edge.
  void go_to(sim::Time at, const sim::Clock& clock) {
    number += at == next ? 1 : clock.cycles(at - now);
    now = at;
    next = clock.after(at, 1);
  }
};

/// Timing wheel (Varghese and Lauck 1987) for the fixed-latency pipelines of one unit: a bit mask of slots for each
/// pipe and cycle. A unit that holds up to 64 slots needs no queue per pipe.
template <std::size_t kPipes>
class TimingWheel {
 public:
  static constexpr std::uint64_t kMostSpan = 64;  ///< latencies must be shorter than this
  using Masks = std::array<std::uint64_t, kPipes>;

  /// `longest`: the longest latency that put() will be given. The wheel has as few bins as hold it.
  TimingWheel(sim::Clock clock, std::uint64_t longest) : clock_(clock), last_(std::bit_ceil(longest + 1) - 1) {
    assert(last_ < kMostSpan);
  }

  /// Moves to a cycle. At most one non-empty one lies between two calls: next() says when.
  void advance(const Cycle& to) {
    cycle_ = to.number;
    now_ = to.now;
  }
  /// Takes the slots that come out at the present cycle, without a branch: whether any do no host foresees.
  Masks take() {
    const std::uint64_t bin = cycle_ & last_;
    const Masks out = bins_[bin];
    bins_[bin] = {};
    occupied_ &= ~(std::uint64_t{1} << bin);
    return out;
  }
  void put(std::size_t pipe, std::uint32_t slot, std::uint64_t latency) {
    assert(latency <= last_);
    const std::uint64_t bin = (cycle_ + latency) & last_;
    bins_[bin][pipe] |= std::uint64_t{1} << slot;
    occupied_ |= std::uint64_t{1} << bin;
  }
  /// When the next slot comes out; kNever if the pipes are empty.
  sim::Time next() const {
    if (occupied_ == 0) return sim::kNever;
    const std::uint64_t bin = cycle_ & last_;
    const std::uint64_t later = occupied_ >> bin;  // else they have gone round
    const int bins =
        later != 0 ? std::countr_zero(later) : static_cast<int>(last_ + 1 - bin) + std::countr_zero(occupied_);
    return now_ + static_cast<sim::Time>(bins) * clock_.period();
  }
  std::uint64_t cycle() const { return cycle_; }
  bool empty() const { return occupied_ == 0; }

 private:
  sim::Clock clock_;
  sim::Time now_ = 0;
  std::uint64_t cycle_ = 0;
  std::uint64_t occupied_ = 0;
  const std::uint64_t last_;  ///< bin
  std::array<Masks, kMostSpan> bins_{};
};

/// Masks of up to 64 slots: of one, and of the first `slots`.
constexpr std::uint64_t bit(std::uint32_t slot) { return std::uint64_t{1} << slot; }
constexpr std::uint64_t all_slots(std::uint32_t slots) { return slots == 64 ? ~std::uint64_t{0} : bit(slots) - 1; }

/// Round robin over a mask: the first set bit at or after `from`, wrapping. `mask` must not be 0.
inline std::uint32_t round_robin(std::uint64_t mask, std::uint32_t from) {
  return (from + static_cast<std::uint32_t>(std::countr_zero(std::rotr(mask, static_cast<int>(from))))) % 64;
}

}  // namespace hw
