#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>

namespace hw {

/// A pipeline of fixed latency that takes one slot a cycle: which of 64 slots comes out in which cycle, and where it
/// goes then. A byte a cycle, where a TimingWheel has a mask for each way out.
class FixedPipe {
 public:
  static constexpr std::uint64_t kBins = 64;  ///< latencies are shorter than this

  /// The slot that comes out, as a mask, and the way that it was given (0 to 3). No slot: the mask is 0, and the way
  /// means nothing.
  struct Out {
    std::uint64_t slots;
    std::size_t way;
  };

  explicit FixedPipe(std::uint32_t latency) : latency_(latency) { assert(latency > 0 && latency < kBins); }

  void put(std::uint32_t slot, std::size_t way, std::uint64_t cycle) {
    const std::uint64_t bin = (cycle + latency_) % kBins;
    assert(((occupied_ >> bin) & 1U) == 0 && "one slot a cycle");
    outs_[bin] = static_cast<std::uint8_t>(slot | way << 6);
    occupied_ |= std::uint64_t{1} << bin;
  }
  /// Takes what comes out in this cycle, without a branch: whether something does no host foresees.
  Out take(std::uint64_t cycle) {
    const std::uint64_t bin = cycle % kBins, due = (occupied_ >> bin) & 1U;
    occupied_ &= ~(std::uint64_t{1} << bin);
    return {due << (outs_[bin] % 64U), std::size_t{outs_[bin]} >> 6};
  }
  /// A bit for each cycle from this one on, the lowest first, in which a slot comes out.
  std::uint64_t comes_out(std::uint64_t cycle) const { return std::rotr(occupied_, static_cast<int>(cycle % kBins)); }

 private:
  std::uint32_t latency_;
  std::uint64_t occupied_ = 0;
  std::array<std::uint8_t, kBins> outs_{};
};

}  // namespace hw
