#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "hw_models/dram/dram_config.h"

namespace hw {

/// Commands in the order of preference. kColumn stands for all read (or write) commands of one line: a train.
enum class DramCommand : std::uint8_t { kColumn, kActivate, kPrecharge };

/// Reservation table of the command bus and the data bus: for each kind of command a bit mask over the next 64 cycles
/// in which it cannot start, because it would meet something booked. What a booked command forbids to each kind is
/// known beforehand, so that booking and asking take no loops; other commands fit between those of a train.
class CommandCalendar {
 public:
  using Cycle = std::uint64_t;

  CommandCalendar(const DramTiming& t, std::uint32_t bursts) {
    const std::array<std::uint64_t, 3> command_bus = {train(bursts, t.ca_column, t.ccd_l), train(1, t.ca_activate, 0),
                                                      train(1, t.ca_precharge, 0)};
    const std::uint64_t data_bus = train(bursts, t.ccd_s, t.ccd_l);
    for (std::size_t booked = 0; booked < 3; ++booked) {
      for (std::size_t asked = 0; asked < 3; ++asked)
        forbids_[booked][asked] = meetings(command_bus[booked], command_bus[asked]);
    }
    forbids_data_ = meetings(data_bus, data_bus);
    forbids_[0][0] |= forbids_data_;
  }

  /// The first cycle, `from` or later, at which the command meets nothing booked.
  Cycle first_free(DramCommand command, Cycle from) const {
    return from + static_cast<Cycle>(std::countr_one(ahead(blocked_[index(command)], from)));
  }
  /// Has the data bus room for a train that starts at `at`?
  bool data_free(Cycle at) const { return (ahead(blocked_data_, at) & 1) == 0; }

  /// Books the command. Cycles before `at` are over and are forgotten.
  void book(DramCommand command, Cycle at) {
    for (std::size_t asked = 0; asked < 3; ++asked)
      blocked_[asked] = ahead(blocked_[asked], at) | forbids_[index(command)][asked];
    blocked_data_ = ahead(blocked_data_, at) | (command == DramCommand::kColumn ? forbids_data_ : 0);
    base_ = at;
  }

 private:
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

  Cycle base_ = 0;
  std::array<std::uint64_t, 3> blocked_{};
  std::uint64_t blocked_data_ = 0;
  std::array<std::array<std::uint64_t, 3>, 3> forbids_{};
  std::uint64_t forbids_data_ = 0;
};

}  // namespace hw
