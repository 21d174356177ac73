#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "sim/time.h"

namespace hw {

/// A clock cycle: its number, the time of its clock edge and the time of the next edge.
struct Cycle {
  sim::Time now, next;
  std::uint64_t number;

  Cycle(sim::Time at, const sim::Clock& clock) : now(at), next(clock.edge_after(at, 1)), number(clock.cycles(at)) {}
  /// Advances this clock cycle to the cycle of a later clock edge, `at`.
  void advance_to(sim::Time at, const sim::Clock& clock) {
    number += at == next ? 1 : clock.cycles(at - now);
    now = at;
    next = clock.edge_after(at, 1);
  }
};

/// Timing wheel (Varghese and Lauck 1987) for the fixed-latency pipelines of a unit with up to 64 slots. For each pipe
/// and each future cycle it stores a bit mask of the slots that complete in that cycle, so pipes need no queues.
template <std::size_t kPipes>
class TimingWheel {
 public:
  static constexpr std::uint64_t kMostSpan = 64;  ///< upper limit of latencies, which must be less than this number of
                                                  ///< cycles
  /// For each pipe of a unit, a mask of slots.
  struct alignas(kPipes * sizeof(std::uint64_t)) Masks : std::array<std::uint64_t, kPipes> {};

  /// `longest_latency`: largest latency, in cycles, that will be passed to schedule_completion(). The wheel has one bin
  /// per cycle, rounded up to a power of two above this latency.
  TimingWheel(sim::Clock clock, std::uint64_t longest_latency)
      : clock_(clock), last_bin_(std::bit_ceil(longest_latency + 1) - 1) {
    assert(last_bin_ < kMostSpan);
  }

  /// Adds the slots that complete in the given cycle to the masks `waiting`. Must be called, in order, for every cycle
  /// in which slots complete (next_completion()). Branch-free, because completions are unpredictable.
  void take_completed(std::uint64_t cycle, Masks& waiting) {
    const std::uint64_t bin = cycle & last_bin_;
    All out, here;
    std::memcpy(&out, &bins_[bin], sizeof out);
    std::memcpy(&here, &waiting, sizeof here);
    here |= out;
    std::memcpy(&waiting, &here, sizeof here);
    bins_[bin] = Masks{};
    occupied_ &= ~(std::uint64_t{1} << bin);
  }
  /// Schedules a slot's completion in a pipe for `latency` cycles after cycle `cycle`.
  void schedule_completion(std::size_t pipe, std::uint32_t slot, std::uint64_t cycle, std::uint64_t latency) {
    assert(latency <= last_bin_);
    const std::uint64_t bin = (cycle + latency) & last_bin_;
    bins_[bin][pipe] |= std::uint64_t{1} << slot;
    occupied_ |= std::uint64_t{1} << bin;
  }
  /// Returns 1 if any slot of the unit completes in the given cycle, else 0.
  std::uint64_t completion_bit_at(std::uint64_t cycle) const { return (occupied_ >> (cycle & last_bin_)) & 1U; }
  /// Returns the time of the first completion in any pipe after the given cycle; kNever if all pipes are empty.
  sim::Time next_completion(const Cycle& cycle) const {
    if (occupied_ == 0) return sim::kNever;
    const std::uint64_t bin = cycle.number & last_bin_;
    const std::uint64_t later = occupied_ >> bin;  // 0: only earlier bins of the ring are occupied
    const int bins =
        later != 0 ? std::countr_zero(later) : static_cast<int>(last_bin_ + 1 - bin) + std::countr_zero(occupied_);
    return clock_.edge_after(cycle.now, static_cast<std::uint64_t>(bins));
  }

 private:
  using All [[gnu::vector_size(sizeof(Masks))]] = std::uint64_t;  ///< the masks of all pipes as one host vector

  sim::Clock clock_;
  std::uint64_t occupied_ = 0;    ///< mask of the bins of the wheel that contain slots
  const std::uint64_t last_bin_;  ///< index of the last bin of the wheel
  std::array<Masks, kMostSpan> bins_{};
};

/// Calls `step` once or, if `drain_all` is true, until it returns false.
template <class Step>
void run_once_or_drain(bool drain_all, Step&& step) {
  while (step() && drain_all) {
  }
}

/// Returns a mask of slots that contains only the given slot.
constexpr std::uint64_t slot_bit(std::uint32_t slot) { return std::uint64_t{1} << slot; }
constexpr std::uint64_t first_slots_mask(std::uint32_t count) {
  return count == 64 ? ~std::uint64_t{0} : slot_bit(count) - 1;
}

/// Returns the index of the first set bit of `mask` at or after bit `first`, wrapping around. The mask must not be 0.
inline std::uint32_t round_robin(std::uint64_t mask, std::uint32_t first) {
  return (first + static_cast<std::uint32_t>(std::countr_zero(std::rotr(mask, static_cast<int>(first))))) % 64;
}

}  // namespace hw
