#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
  /// A mask for each pipe.
  struct alignas(kPipes * sizeof(std::uint64_t)) Masks : std::array<std::uint64_t, kPipes> {};

  /// `longest`: the longest latency that put() will be given. The wheel has as few bins as hold it.
  TimingWheel(sim::Clock clock, std::uint64_t longest) : clock_(clock), last_(std::bit_ceil(longest + 1) - 1) {
    assert(last_ < kMostSpan);
  }

  /// Moves the slots that complete in this cycle into `waiting`. Branch-free: completions are unpredictable. Must be
  /// called in every cycle in which slots complete, in order (next()).
  void take(std::uint64_t cycle, Masks& waiting) {
    const std::uint64_t bin = cycle & last_;
    All out, here;
    std::memcpy(&out, &bins_[bin], sizeof out);
    std::memcpy(&here, &waiting, sizeof here);
    here |= out;
    std::memcpy(&waiting, &here, sizeof here);
    bins_[bin] = Masks{};
    occupied_ &= ~(std::uint64_t{1} << bin);
  }
  /// The slot comes out `latency` after this cycle.
  void put(std::size_t pipe, std::uint32_t slot, std::uint64_t cycle, std::uint64_t latency) {
    assert(latency <= last_);
    const std::uint64_t bin = (cycle + latency) & last_;
    bins_[bin][pipe] |= std::uint64_t{1} << slot;
    occupied_ |= std::uint64_t{1} << bin;
  }
  /// Returns 1 if a slot comes out in this cycle, else 0.
  std::uint64_t comes_out(std::uint64_t cycle) const { return (occupied_ >> (cycle & last_)) & 1U; }
  /// Returns when the next slot comes out after this cycle; kNever if the pipes are empty.
  sim::Time next(const Cycle& cycle) const {
    if (occupied_ == 0) return sim::kNever;
    const std::uint64_t bin = cycle.number & last_;
    const std::uint64_t later = occupied_ >> bin;  // else they have gone round
    const int bins =
        later != 0 ? std::countr_zero(later) : static_cast<int>(last_ + 1 - bin) + std::countr_zero(occupied_);
    return clock_.after(cycle.now, static_cast<std::uint64_t>(bins));
  }

 private:
  using All [[gnu::vector_size(sizeof(Masks))]] = std::uint64_t;  ///< the host moves them all at once

  sim::Clock clock_;
  std::uint64_t occupied_ = 0;  ///< bins
  const std::uint64_t last_;    ///< bin
  std::array<Masks, kMostSpan> bins_{};
};

/// Runs `step` once or, for an ideal unit, until it returns false.
template <class Step>
void run_once_or_drain(bool drain_all, Step&& step) {
  while (step() && drain_all) {
  }
}

/// Masks of up to 64 slots: of one, and of the first `slots`.
constexpr std::uint64_t bit(std::uint32_t slot) { return std::uint64_t{1} << slot; }
constexpr std::uint64_t all_slots(std::uint32_t slots) { return slots == 64 ? ~std::uint64_t{0} : bit(slots) - 1; }

/// Round robin over a mask: the first set bit at or after `from`, wrapping. `mask` must not be 0.
inline std::uint32_t round_robin(std::uint64_t mask, std::uint32_t from) {
  return (from + static_cast<std::uint32_t>(std::countr_zero(std::rotr(mask, static_cast<int>(from))))) % 64;
}

}  // namespace hw
