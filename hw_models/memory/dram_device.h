#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hw_models/memory/command_calendar.h"
#include "hw_models/memory/dram_config.h"

namespace hw {

/// What a channel's time goes to.
enum class DramWhy : std::uint8_t {
  kIdle,         ///< nothing queued, no data expected
  kReading,      ///< read data on the bus
  kWriting,      ///< write data on the bus
  kLatency,      ///< nothing queued, data on their way
  kRowConflict,  ///< another row must be closed first (tRAS, tRTP, tWR, tRP)
  kActivate,     ///< a row is being opened, or activates follow too closely (tRCD, tRC, tRRD, tFAW)
  kRefresh,      ///< the bank is refreshing
  kTurnaround,   ///< the data bus changes direction
  kColumn,       ///< column commands follow too closely (tCCD)
  kCommandBus,   ///< the command bus is taken
  kReturnsFull,  ///< reads cannot start because responses do not leave
  kCount
};
constexpr std::array<std::string_view, 11> names_of(DramWhy) {
  return {"idle",    "reading",    "writing", "latency",     "row_conflict", "activate",
          "refresh", "turnaround", "column",  "command_bus", "returns_full"};
}

/// The banks and busses of one channel: which command may run when. State is "the first cycle at which this may
/// happen", never a countdown. Cycles are those of the command clock.
class DramDevice {
 public:
  using Cycle = std::uint64_t;
  static constexpr std::uint32_t kMaxBanks = 32;
  static constexpr std::uint32_t kMaxGroups = 8;

  explicit DramDevice(const DramConfig& config);

  bool is_open(std::uint32_t bank) const { return ((open_ >> bank) & 1) != 0; }
  bool is_open(std::uint32_t bank, std::uint32_t row) const { return is_open(bank) && rows_[bank] == row; }

  /// The command that a request needs next in this bank.
  DramCommand needed(std::uint32_t bank, bool hits) const {
    return hits ? DramCommand::kColumn : is_open(bank) ? DramCommand::kPrecharge : DramCommand::kActivate;
  }

  /// What binds every bank, by command.
  using Floors = std::array<Cycle, 3>;
  Floors floors(bool write, Cycle now) const;
  /// The first cycle at which the command may run in the bank.
  Cycle earliest(DramCommand command, std::uint32_t bank, bool write, const Floors& floors) const {
    const auto c = static_cast<std::size_t>(command);
    const std::size_t row = command != DramCommand::kColumn ? kNoGroupRule : write ? kWriteTrain : kReadTrain;
    return calendar_.first_free(command, std::max({floors[c], bank_at_[c][bank], group_at_[row][group_of(bank)]}));
  }
  /// What keeps the command from running one cycle before `at`, its earliest cycle; true of every cycle until then.
  DramWhy reason(DramCommand command, std::uint32_t bank, bool write, Cycle at) const;

  void activate(std::uint32_t bank, std::uint32_t row, Cycle now);
  void precharge(std::uint32_t bank, Cycle now);
  /// The bursts of one line; returns the cycle of the first data.
  Cycle read(std::uint32_t bank, Cycle now);
  Cycle write(std::uint32_t bank, Cycle now);
  /// First data to the end of the last burst of a line.
  Cycle data_cycles() const { return train_length_ + t_.burst; }
  /// Calls f(begin, end) for the stretches in which a line whose data begin at `data` holds the data bus.
  void each_burst(Cycle data, auto&& f) const {
    if (t_.ccd_l == t_.burst) return f(data, data + data_cycles());
    for (Cycle begin = data; begin <= data + train_length_; begin += t_.ccd_l) f(begin, begin + t_.burst);
  }

  /// Refreshes the bank as soon as it may after `due`, closing it first.
  void refresh(std::uint32_t bank, Cycle due);

  std::uint32_t open_banks() const;
  std::uint64_t turnarounds() const { return turnarounds_; }
  /// Cycles before `until` in which a row was open somewhere. `until` never goes back.
  Cycle active_cycles(Cycle until);

 private:
  enum GroupRule : std::uint8_t { kReadTrain, kWriteTrain, kNoGroupRule };

  Cycle& at(DramCommand command, std::uint32_t bank) { return bank_at_[static_cast<std::size_t>(command)][bank]; }
  Cycle at(DramCommand command, std::uint32_t bank) const { return bank_at_[static_cast<std::size_t>(command)][bank]; }
  std::uint32_t group_of(std::uint32_t bank) const { return bank & group_mask_; }
  void close(std::uint32_t bank, Cycle now);
  void book_train(bool write, Cycle now);

  const DramTiming t_;
  const std::uint32_t group_mask_;
  const Cycle train_length_;  ///< first to last column command of a line

  std::uint32_t open_ = 0;  ///< a bit per bank
  std::array<std::uint32_t, kMaxBanks> rows_{};
  std::array<std::array<Cycle, kMaxBanks>, 3> bank_at_{};
  std::array<DramWhy, kMaxBanks> closed_why_{};  ///< what an activate of the closed bank waits for
  std::array<std::array<Cycle, kMaxGroups>, 3> group_at_{};
  Cycle read_at_ = 0, write_at_ = 0;       ///< after data in the other direction
  Cycle activate_at_ = 0;                  ///< tRRD
  std::array<Cycle, 4> four_activates_{};  ///< tFAW: when each of the last four leaves the window
  std::uint32_t oldest_activate_ = 0;
  CommandCalendar calendar_;
  bool last_was_write_ = false;
  std::uint64_t turnarounds_ = 0;

  Cycle active_ = 0;  ///< counted up to active_since_
  Cycle active_since_ = 0, active_until_ = 0;
};

}  // namespace hw
