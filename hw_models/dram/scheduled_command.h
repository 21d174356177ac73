#pragma once
#include <compare>
#include <cstdint>

#include "hw_models/dram/command_calendar.h"
#include "sim/time.h"

namespace hw {

/// The command that a channel runs next if nothing new arrives, in one number that sorts by preference: the earliest,
/// then the kind of command, then the oldest request; the bank comes along in the low bits.
class ScheduledCommand {
 public:
  using Cycle = CommandCalendar::Cycle;

  /// No command.
  ScheduledCommand() = default;
  /// `position`: of the request in its DramQueue.
  ScheduledCommand(Cycle at, DramCommand command, std::uint32_t position, std::uint32_t bank)
      : key_(at << kAt.first | std::uint64_t{static_cast<std::uint8_t>(command)} << kCommand.first |
             position << kPosition.first | bank << kBank.first) {}

  bool none() const { return key_ == kNone; }
  Cycle at() const { return none() ? sim::kNever : kAt.of(key_); }
  DramCommand command() const { return static_cast<DramCommand>(kCommand.of(key_)); }
  std::uint32_t position() const { return static_cast<std::uint32_t>(kPosition.of(key_)); }
  std::uint32_t bank() const { return static_cast<std::uint32_t>(kBank.of(key_)); }
  friend auto operator<=>(const ScheduledCommand&, const ScheduledCommand&) = default;

 private:
  /// Bits of the key from `first` on.
  struct BitField {
    std::uint32_t first, bits;
    constexpr std::uint64_t of(std::uint64_t key) const { return key >> first & ((std::uint64_t{1} << bits) - 1); }
  };
  static constexpr BitField kBank{0, 5}, kPosition{5, 6}, kCommand{11, 2}, kAt{13, 51};

  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::uint64_t key_ = kNone;
};

}  // namespace hw
