#pragma once
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "hw_models/dram/dram_config.h"

namespace hw {

/// Commands in the order of preference. kColumn stands for all read (or write) commands of one line: a train.
enum class DramCommand : std::uint8_t { kColumn, kActivate, kPrecharge };

/// Reservation table of the command bus and the data bus: for each kind of command a bit mask over the next 64 cycles
/// in which it cannot start, because it would meet something booked. What a booked command forbids to each kind is
/// known beforehand, so that booking and asking take no loops; other commands fit between those of a train.
/// With tAAD an activate is ACT-1 and, in the first free slot behind it that is not later, ACT-2.
class CommandCalendar {
 public:
  using Cycle = std::uint64_t;

  /// A line takes `bursts`, which so many column commands move.
  CommandCalendar(const DramTiming& t, std::uint32_t bursts, std::uint32_t commands)
      : half_(t.aad == 0 ? 0 : t.ca_activate / 2),
        aad_(t.aad),
        sync_(t.wck_sync),
        command_bus_{train(commands, t.ca_column, t.ccd_l * (bursts / commands)),
                     train(1, half_ == 0 ? t.ca_activate : half_, 0), train(1, t.ca_precharge, 0),
                     train(1, t.wck_sync, 0)},
        data_bus_(train(bursts, t.ccd_s, t.ccd_l)) {
    for (std::size_t booked = 0; booked < kKinds; ++booked) {
      for (std::size_t asked = 0; asked < kKinds; ++asked)
        forbids_[booked][asked] = meetings(command_bus_[booked], command_bus_[asked]);
    }
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      second_[asked] = starts(command_bus_[asked], train(1, half_, 0) << kLatest);
    forbids_data_ = meetings(data_bus_, data_bus_);
    forbids_[0][0] |= forbids_data_;
  }

  /// The first cycle, `from` or later, at which the command meets nothing booked.
  Cycle first_free(DramCommand command, Cycle from) const {
    std::uint64_t blocked = ahead(blocked_[index(command)], from);
    if (command == DramCommand::kActivate && half_ != 0 && blocked != 0) {
      std::uint64_t no_second = ~std::uint64_t{0};
      for (std::uint32_t d = half_; d <= aad_; ++d) no_second &= blocked >> d;
      blocked |= no_second;
    }
    return from + static_cast<Cycle>(std::countr_one(blocked));
  }
  /// The same for a column command with the CAS that starts WCK before it.
  Cycle first_free_with_sync(Cycle from) const {
    const std::uint64_t blocked = ahead(blocked_[kSync], from) | ahead(blocked_[0], from + sync_);
    return from + static_cast<Cycle>(std::countr_one(blocked));
  }
  /// Has the data bus room for a train that starts at `at`?
  bool data_free(Cycle at) const { return (ahead(blocked_data_, at) & 1) == 0; }

  /// Books the command. Cycles before `at` are over and are forgotten.
  void book(DramCommand command, Cycle at) {
    book(index(command), at);
    if (command == DramCommand::kColumn) blocked_data_ |= forbids_data_;
    if (command == DramCommand::kActivate && half_ != 0) {
      const std::uint64_t behind = blocked_[index(DramCommand::kActivate)] >> half_;
      const std::uint32_t second = half_ + static_cast<std::uint32_t>(std::countr_one(behind));
      assert(second <= kLatest);
      for (std::size_t asked = 0; asked < kKinds; ++asked) blocked_[asked] |= second_[asked] >> (kLatest - second);
    }
  }
  /// A CAS at `at`, and a column command behind it.
  void book_with_sync(Cycle at) {
    book(kSync, at);
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      blocked_[asked] |= starts(command_bus_[asked], command_bus_[index(DramCommand::kColumn)] << sync_);
    const std::uint64_t data = starts(data_bus_, data_bus_ << sync_);
    blocked_data_ |= data;
    blocked_[index(DramCommand::kColumn)] |= data;
  }

 private:
  static constexpr std::size_t kSync = 3, kKinds = 4;
  static constexpr std::uint32_t kLatest = 32;  ///< cycles from ACT-1 to ACT-2, at most: tAAD is below

  void book(std::size_t kind, Cycle at) {
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      blocked_[asked] = ahead(blocked_[asked], at) | forbids_[kind][asked];
    blocked_data_ = ahead(blocked_data_, at);
    base_ = at;
  }
  /// Starts at which a pattern `asked` meets what is booked.
  static std::uint64_t starts(std::uint64_t asked, std::uint64_t booked) {
    std::uint64_t all = 0;
    for (; asked != 0; asked &= asked - 1) all |= booked >> std::countr_zero(asked);
    return all;
  }
  static constexpr std::size_t index(DramCommand command) { return static_cast<std::size_t>(command); }

  /// The pattern of `count` blocks of `length` cycles each, `stride` cycles apart.
  static constexpr std::uint64_t train(std::uint32_t count, std::uint32_t length, std::uint32_t stride) {
    std::uint64_t pattern = 0;
    for (std::uint32_t i = 0; i < count; ++i) pattern |= ((std::uint64_t{1} << length) - 1) << (i * stride);
    return pattern;
  }
  /// The distances, in cycles, at which a pattern `asked` would meet a pattern `booked` that started before it.
  static constexpr std::uint64_t meetings(std::uint64_t booked, std::uint64_t asked) {
    std::uint64_t distances = 0;
    for (std::uint32_t d = 0; d < 64; ++d) {
      if (((booked >> d) & asked) != 0) distances |= std::uint64_t{1} << d;
    }
    return distances;
  }
  std::uint64_t ahead(std::uint64_t mask, Cycle from) const { return from - base_ >= 64 ? 0 : mask >> (from - base_); }

  const std::uint32_t half_;  ///< cycles of ACT-1, and of ACT-2; 0: an activate is one block
  const std::uint32_t aad_, sync_;
  const std::array<std::uint64_t, kKinds> command_bus_;  ///< the pattern of each kind of command
  const std::uint64_t data_bus_;                         ///< pattern of a line
  Cycle base_ = 0;
  std::array<std::uint64_t, kKinds> blocked_{};
  std::uint64_t blocked_data_ = 0;
  std::array<std::array<std::uint64_t, kKinds>, kKinds> forbids_{};
  std::uint64_t forbids_data_ = 0;
  std::array<std::uint64_t, kKinds> second_{};  ///< what an ACT-2 forbids to each kind, if it begins kLatest behind now
};

}  // namespace hw
