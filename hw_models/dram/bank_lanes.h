#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>

namespace hw {

/// An array with one number for each bank of a DRAM channel, over all ranks. Functions process four banks at a time,
/// without branches. They take and return sets of banks as bit masks, one bit per bank.
class BankLanes {
 public:
  static constexpr std::uint32_t kMaxBanks = 32;  ///< maximum number of banks of a channel, over all ranks

  /// Creates an array of zeros for the `bank_count` banks of a DRAM channel.
  explicit BankLanes(std::uint32_t bank_count) : fours_((bank_count + kWidth - 1) / kWidth) {}

  std::uint64_t& operator[](std::size_t bank) { return all_[bank]; }
  std::uint64_t operator[](std::size_t bank) const { return all_[bank]; }

  /// Returns a mask of the DRAM banks whose number in this array is at most `limit`. `limit` must be below 2^63. Mask
  /// bits above the last bank are undefined.
  std::uint32_t banks_with_value_at_most(std::uint64_t limit) const {
    return banks_with_value_at_most(limit, [&](std::uint32_t four) { return load_four(four); });
  }
  /// Returns a mask of the banks whose numbers in this array and in the array `other` are both at most `limit`.
  std::uint32_t banks_with_both_at_most(const BankLanes& other, std::uint64_t limit) const {
    return banks_with_value_at_most(limit,
                                    [&](std::uint32_t four) { return max_of(load_four(four), other.load_four(four)); });
  }
  /// Returns the smallest number that this array stores for the banks in the mask `bank_mask`.
  std::uint64_t min_of(std::uint32_t bank_mask) const {
    return min_of(bank_mask, [&](std::uint32_t four) { return load_four(four); });
  }
  /// Takes, for each bank in the mask `bank_mask`, the larger of its numbers in this array and in the array `other`.
  /// Returns the minimum over these banks.
  std::uint64_t min_of_maxima_with(const BankLanes& other, std::uint32_t bank_mask) const {
    return min_of(bank_mask, [&](std::uint32_t four) { return max_of(load_four(four), other.load_four(four)); });
  }
  /// Returns the bitwise OR of the numbers in this array for the banks in the mask `bank_mask`.
  std::uint64_t bitwise_or_of(std::uint32_t bank_mask) const {
    Four any{};
    for_each_four([&](std::uint32_t four, const Four& bit) { any |= load_four(four) & ((bit & bank_mask) == bit); });
    return static_cast<std::uint64_t>(any[0] | any[1] | any[2] | any[3]);
  }
  /// Raises the number of each bank in the mask `bank_mask`, in this array, to at least `minimum`.
  void raise_to_at_least(std::uint32_t bank_mask, std::uint64_t minimum) {
    const Four bound = Four{} + static_cast<std::int64_t>(minimum);
    Four bit{1, 2, 4, 8};
    for (std::uint32_t four = 0; four < fours_; ++four, bit <<= kWidth) {
      const Four number = load_four(four), above = ((bit & bank_mask) == bit) & (bound > number);
      const Four raised = (bound & above) | (number & ~above);
      std::memcpy(&all_[std::size_t{four} * kWidth], &raised, sizeof raised);
    }
  }
  /// Replaces the number n of every bank in this array by f(n). The loop is written so that the compiler can vectorise
  /// it.
  template <class F>
  void transform_all(F&& f) {
    for (std::uint32_t bank = 0; bank < fours_ * kWidth; ++bank) all_[bank] = f(all_[bank]);
  }

 private:
  static constexpr std::uint32_t kWidth = 4;
  using Four [[gnu::vector_size(32)]] = std::int64_t;  // four numbers; signed, because SIMD comparisons are signed

  /// Calls f(i, bits) for each group of four banks. `i`: index of the group; `bits`: mask bit of each of its banks.
  template <class F>
  void for_each_four(F&& f) const {
    Four bit{1, 2, 4, 8};
    for (std::uint32_t four = 0; four < fours_; ++four, bit <<= kWidth) f(four, bit);
  }
  template <class Get>
  std::uint32_t banks_with_value_at_most(std::uint64_t limit, Get&& get) const {
    Four banks{};
    for_each_four(
        [&](std::uint32_t four, const Four& bit) { banks |= bit & (get(four) <= static_cast<std::int64_t>(limit)); });
    return static_cast<std::uint32_t>(banks[0] | banks[1] | banks[2] | banks[3]);
  }
  template <class Get>
  std::uint64_t min_of(std::uint32_t bank_mask, Get&& get) const {
    constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
    Four least{kNone, kNone, kNone, kNone};
    for_each_four([&](std::uint32_t four, const Four& bit) {
      const Four asked = (bit & bank_mask) == bit, number = get(four), less = asked & (number < least);
      least = (number & less) | (least & ~less);
    });
    return static_cast<std::uint64_t>(std::min(std::min(least[0], least[1]), std::min(least[2], least[3])));
  }
  Four load_four(std::uint32_t four) const {
    Four numbers;
    std::memcpy(&numbers, &all_[std::size_t{four} * kWidth], sizeof numbers);
    return numbers;
  }
  static Four max_of(const Four& a, const Four& b) {
    const Four above = a > b;
    return (a & above) | (b & ~above);
  }

  std::uint32_t fours_;
  alignas(32) std::array<std::uint64_t, kMaxBanks> all_{};
};

}  // namespace hw
