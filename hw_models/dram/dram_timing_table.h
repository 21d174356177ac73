#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hw_models/dram/dram_config.h"
#include "sim/activity.h"

namespace hw {

/// Reasons for a channel's cycles.
enum class DramCycleReason : std::uint8_t {
  kIdle,
  kReading,
  kWriting,
  kLatency,
  kRowConflict,
  kActivate,
  kRefresh,
  kTurnaround,
  kColumn,
  kCommandBus,
  kReturnsFull,
  kRankSwitch,
  kPowerDown,
  kCount
};
inline constexpr auto kDramReasons = sim::reasons<DramCycleReason>({
    {DramCycleReason::kIdle, sim::idle("idle", "nothing queued, no data expected")},
    {DramCycleReason::kReading, sim::working("reading", "read data on the bus")},
    {DramCycleReason::kWriting, sim::working("writing", "write data on the bus")},
    {DramCycleReason::kLatency, sim::working("latency", "nothing queued, data on their way")},
    {DramCycleReason::kRowConflict,
     sim::working("row_conflict", "another row must be closed first (tRAS, tRTP, tWR, tRP)")},
    {DramCycleReason::kActivate,
     sim::working("activate", "a row is being opened, or activates follow too closely (tRCD, tRC, tRRD, tFAW)")},
    {DramCycleReason::kRefresh, sim::background("refresh", "the bank is refreshing")},
    {DramCycleReason::kTurnaround, sim::working("turnaround", "the data bus changes direction")},
    {DramCycleReason::kColumn, sim::working("column", "column commands follow too closely (tCCD)")},
    {DramCycleReason::kCommandBus, sim::working("command_bus", "the command bus is taken")},
    {DramCycleReason::kReturnsFull, sim::waiting("returns_full", "reads cannot start because responses do not leave")},
    {DramCycleReason::kRankSwitch, sim::working("rank_switch", "the data bus changes from one rank to another")},
    {DramCycleReason::kPowerDown, sim::working("power_down_exit", "the device leaves power-down (tXP)")},
});

/// Operation of a bank or a rank that timing constraints lead from or to. A read or write is all column commands of one
/// line: its time is that of the first.
enum class DramOp : std::uint8_t { kRead, kWrite, kActivate, kPrecharge, kRefresh, kRefreshRank, kCount };
inline constexpr std::size_t kDramOps = static_cast<std::size_t>(DramOp::kCount);

/// Banks that a constraint binds, as seen from the bank of the operation that it leads from.
enum class DramScope : std::uint8_t { kBank, kBankGroup, kRank, kOtherRanks };

/// No `to` within `scope` starts earlier than `cycles` after a `from`, or after the `count`th last of them.
struct DramConstraint {
  DramScope scope = DramScope::kBank;
  DramOp from = DramOp::kRead, to = DramOp::kRead;
  std::int64_t cycles = 0;
  DramCycleReason reason = DramCycleReason::kColumn;  ///< of a channel whose rank waits for it
  std::uint32_t count = 1;
};

/// The timing constraints of a grade, from its file (configs/dram/). To add a command: an operation, its rows here, and
/// the change of state that it makes in DramDevice.
class DramTimingTable {
 public:
  explicit DramTimingTable(const DramConfig& config);

  /// The constraints of a scope that lead from an operation.
  std::span<const DramConstraint> after(DramOp from, DramScope scope) const { return rows(from, scope); }

 private:
  using Rows = std::vector<DramConstraint>;
  const Rows& rows(DramOp from, DramScope scope) const {
    return rows_[static_cast<std::size_t>(from)][static_cast<std::size_t>(scope)];
  }

  std::array<std::array<Rows, 4>, kDramOps> rows_;
};

}  // namespace hw
