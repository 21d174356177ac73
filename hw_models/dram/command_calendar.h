#pragma once
#include <algorithm>
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
/// With tAAD an activate is ACT-1 and, at most tAAD later, ACT-2. ACT-2 makes way for reads and writes while it has
/// another slot; no ACT-1 comes before it.
class CommandCalendar {
 public:
  using Cycle = std::uint64_t;

  /// A line takes `bursts`, moved by `commands` column commands.
  CommandCalendar(const DramTiming& t, std::uint32_t bursts, std::uint32_t commands)
      : half_(t.aad == 0 ? 0 : t.ca_activate / 2),
        aad_(t.aad),
        command_bus_{
            train(commands, t.ca_column, t.ccd_l * (bursts / commands)),
            train(1, half_ == 0 ? t.ca_activate : half_, 0), train(1, t.ca_precharge, 0),
            (train(commands, t.ca_column, t.ccd_l * (bursts / commands)) << t.wck_sync) | train(1, t.wck_sync, 0)},
        data_bus_(train(bursts, t.ccd_s, t.ccd_l)) {
    for (std::size_t booked = 0; booked < kKinds; ++booked) {
      for (std::size_t asked = 0; asked < kKinds; ++asked)
        forbids_[booked][asked] = meetings(command_bus_[booked], command_bus_[asked]);
    }
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      second_[asked] = starts(command_bus_[asked], train(1, half_, 0) << kLatest);
    const std::uint64_t data_after_cas = data_bus_ << t.wck_sync;
    for (const std::size_t kind : {kColumn, kSync}) {
      const std::uint64_t data = kind == kSync ? data_after_cas : data_bus_;
      forbids_data_[kind == kSync] = starts(data_bus_, data);
      forbids_[kind][kColumn] |= starts(data_bus_, data);
      forbids_[kind][kSync] |= starts(data_after_cas, data);
    }
  }

  /// Returns the first cycle, `from` or later, at which the command meets nothing booked.
  Cycle first_free(DramCommand command, Cycle from) const {
    if (command != DramCommand::kActivate) return first_free(index(command), from);
    if (half_ == 0) return from + distance_to_free(ahead(blocked_[kActivate], from));
    from = std::max(from, second_at_ + half_);
    std::uint64_t blocked = ahead(blocked_[kActivate], from);
    std::uint64_t no_second = ~std::uint64_t{0};
    for (std::uint32_t d = half_; d <= aad_; ++d) no_second &= blocked >> d;
    return from + distance_to_free(blocked | no_second);
  }
  /// Returns the first cycle, `from` or later, at which a CAS fits with a column command after it.
  Cycle first_free_with_sync(Cycle from) const { return first_free(kSync, from); }
  /// Has the data bus room for a train that starts at `at`?
  bool data_free(Cycle at) const { return (ahead(blocked_data_, at) & 1) == 0; }

  /// Books the command. Cycles before `at` are over and are forgotten.
  void book(DramCommand command, Cycle at) {
    book(index(command), at);
    if (command != DramCommand::kActivate || half_ == 0) return;
    second_until_ = at + aad_;
    second_at_ = at + half_ + distance_to_free(blocked_[kActivate] >> half_);
    assert(second_at_ <= second_until_);
  }
  /// Books a CAS at `at`, and a column command after it.
  void book_with_sync(Cycle at) { book(kSync, at); }

 private:
  static constexpr std::size_t kColumn = 0, kActivate = 1, kPrecharge = 2, kSync = 3, kKinds = 4;
  static constexpr std::uint32_t kLatest = 32;  ///< more than the cycles from a command to any ACT-2 that it may meet

  static constexpr std::size_t index(DramCommand command) { return static_cast<std::size_t>(command); }
  /// Returns the first start that is not blocked.
  static Cycle distance_to_free(std::uint64_t blocked) { return static_cast<Cycle>(std::countr_one(blocked)); }

  Cycle first_free(std::size_t kind, Cycle from) const {
    std::uint64_t blocked = ahead(blocked_[kind], from);
    Cycle at = from + distance_to_free(blocked);
    while (meets_second(kind, at) && !can_displace_second(kind, at)) {
      blocked |= std::uint64_t{1} << (at - from);
      at = from + distance_to_free(blocked);
    }
    return at;
  }
  /// True if the command, at `at`, would take the slot of an ACT-2.
  bool meets_second(std::size_t kind, Cycle at) const {
    return at < second_at_ + half_ && ((second_[kind] >> (kLatest + at - second_at_)) & 1) != 0;
  }
  bool can_displace_second(std::size_t kind, Cycle at) const {
    return kind != kPrecharge && at <= second_at_ && second_if_booked(kind, at) <= second_until_;
  }
  /// Returns the slot to which ACT-2 moves if the command is booked at `at`.
  Cycle second_if_booked(std::size_t kind, Cycle at) const {
    return at + distance_to_free(ahead(blocked_[kActivate], at) | forbids_[kind][kActivate]);
  }
  void book(std::size_t kind, Cycle at) {
    if (meets_second(kind, at)) second_at_ = second_if_booked(kind, at);
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      blocked_[asked] = ahead(blocked_[asked], at) | forbids_[kind][asked];
    blocked_data_ = ahead(blocked_data_, at);
    if (kind == kColumn || kind == kSync) blocked_data_ |= forbids_data_[kind == kSync];
    base_ = at;
  }
  /// Returns the starts at which a pattern `asked` meets what is booked.
  static std::uint64_t starts(std::uint64_t asked, std::uint64_t booked) {
    std::uint64_t all = 0;
    for (; asked != 0; asked &= asked - 1) all |= booked >> std::countr_zero(asked);
    return all;
  }
  /// Returns the pattern of `count` blocks of `length` cycles each, `stride` cycles apart.
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
  const std::uint32_t aad_;
  const std::array<std::uint64_t, kKinds> command_bus_;  ///< the pattern of each kind of command
  const std::uint64_t data_bus_;                         ///< pattern of a line
  Cycle base_ = 0;
  std::array<std::uint64_t, kKinds> blocked_{};  ///< without an ACT-2 to come
  std::uint64_t blocked_data_ = 0;
  Cycle second_at_ = 0, second_until_ = 0;  ///< slot of the last ACT-2, and the last one that it may take
  std::array<std::array<std::uint64_t, kKinds>, kKinds> forbids_{};
  std::array<std::uint64_t, 2> forbids_data_{};  ///< by a column command, and by one with its CAS
  std::array<std::uint64_t, kKinds> second_{};   ///< starts of each kind that meet an ACT-2 kLatest cycles from now
};

}  // namespace hw
