#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "hw_models/dram/dram_config.h"
#include "sim/activity.h"

namespace hw {

/// Reasons to which a DRAM channel charges its cycles.
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
    {DramCycleReason::kIdle, sim::idle_reason("idle", "nothing queued, no data expected")},
    {DramCycleReason::kReading, sim::working_reason("reading", "read data are on the data bus")},
    {DramCycleReason::kWriting, sim::working_reason("writing", "write data are on the data bus")},
    {DramCycleReason::kLatency, sim::working_reason("latency", "nothing queued, data in flight")},
    {DramCycleReason::kRowConflict,
     sim::working_reason("row_conflict", "another row must be closed first (tRAS, tRTP, tWR, tRP)")},
    {DramCycleReason::kActivate,
     sim::working_reason("activate",
                         "a row is being opened, or an activate waits for an earlier one (tRCD, tRC, tRRD, tFAW)")},
    {DramCycleReason::kRefresh, sim::background_reason("refresh", "the bank is refreshing")},
    {DramCycleReason::kTurnaround, sim::working_reason("turnaround", "the data bus changes direction")},
    {DramCycleReason::kColumn, sim::working_reason("column", "a column command waits for an earlier one (tCCD)")},
    {DramCycleReason::kCommandBus, sim::working_reason("command_bus", "the command bus is occupied")},
    {DramCycleReason::kReturnsFull,
     sim::waiting_reason("returns_full", "reads cannot start because responses wait for room")},
    {DramCycleReason::kRankSwitch, sim::working_reason("rank_switch", "the data bus changes from one rank to another")},
    {DramCycleReason::kPowerDown, sim::working_reason("power_down_exit", "the device leaves power-down (tXP)")},
});

/// Operations of a DRAM bank or rank between which timing constraints apply. A read or write operation consists of all
/// column commands of one line and starts with the first of them.
enum class DramOp : std::uint8_t { kRead, kWrite, kActivate, kPrecharge, kRefresh, kRefreshRank };

/// Banks to which a DRAM timing constraint applies, relative to the bank of the earlier operation.
enum class DramScope : std::uint8_t { kBank, kBankGroup, kRank, kOtherRanks };

/// DRAM timing parameters in cycles, and sums of them that several constraints use.
struct DramTerms : DramTiming {
  explicit DramTerms(const DramConfig& c)
      : DramTiming(c.timing),
        column_span(std::int64_t{c.bursts_per_line() - 1} * ccd_l),
        read_latency(std::int64_t{rl} + dqsck),
        write_latency(std::int64_t{wl} + dqss),
        read_end(column_span + read_latency + burst),
        write_end(column_span + write_latency + burst) {}

  std::int64_t column_span;                  ///< cycles from the first to the last column command of a line
  std::int64_t read_latency, write_latency;  ///< cycles from a column command to its first data
  std::int64_t read_end, write_end;          ///< cycles from the first column command of a line to the end of its data
};

/// A DRAM timing constraint: operation `to` must start at least `cycles` after the last operation `from`, on all banks
/// of `scope`. If `count` > 1, the distance is measured from the `count`th last operation `from`.
struct DramConstraint {
  DramScope scope;
  DramOp from, to;
  std::int64_t (*cycles)(const DramTerms& t);         ///< minimum distance of the two operations in cycles; may be
                                                      ///< negative between ranks
  DramCycleReason reason = DramCycleReason::kColumn;  ///< reason to which cycles spent waiting for this constraint are
                                                      ///< charged
  std::uint32_t count = 1;
};

/// The timing constraints of all DRAM speed grades (JESD209). DramDevice applies them after each operation. To add a
/// command, add an operation, its rows in this table, and its state change in DramDevice.
inline constexpr auto kDramConstraints = [] {
  using enum DramScope;
  using Op = DramOp;
  using Reason = DramCycleReason;
  using Terms = const DramTerms&;
  return std::to_array<DramConstraint>({
      {kBank, Op::kActivate, Op::kRead, [](Terms t) { return std::int64_t{t.rcd}; }},
      {kBank, Op::kActivate, Op::kWrite, [](Terms t) { return std::int64_t{t.rcd}; }},
      {kBank, Op::kActivate, Op::kPrecharge, [](Terms t) { return std::int64_t{t.ras}; }},
      {kBank, Op::kActivate, Op::kActivate, [](Terms t) { return std::int64_t{t.rc}; }},
      {kRank, Op::kActivate, Op::kActivate, [](Terms t) { return std::int64_t{t.rrd}; }, Reason::kActivate},
      {kRank, Op::kActivate, Op::kActivate, [](Terms t) { return std::int64_t{t.faw}; }, Reason::kActivate, 4},

      {kBank, Op::kPrecharge, Op::kActivate, [](Terms t) { return std::int64_t{t.rp}; }},

      {kBank, Op::kRead, Op::kPrecharge, [](Terms t) { return t.column_span + t.rtp; }},
      {kBankGroup, Op::kRead, Op::kRead, [](Terms t) { return t.column_span + t.ccd_l; }},
      {kBankGroup, Op::kRead, Op::kWrite, [](Terms t) { return t.column_span + t.ccd_l; }},
      {kRank, Op::kRead, Op::kWrite, [](Terms t) { return t.read_end + t.rtw - t.wl; }, Reason::kTurnaround},
      {kOtherRanks, Op::kRead, Op::kRead, [](Terms t) { return t.column_span + t.burst + t.rtrs; },
       Reason::kRankSwitch},
      {kOtherRanks, Op::kRead, Op::kWrite, [](Terms t) { return t.read_end + t.rtw - t.wl; }, Reason::kTurnaround},
      {kOtherRanks, Op::kRead, Op::kWrite, [](Terms t) { return t.read_end + t.rtrs - t.wl; }, Reason::kRankSwitch},

      {kBank, Op::kWrite, Op::kPrecharge, [](Terms t) { return t.write_end + t.wr; }},
      {kBankGroup, Op::kWrite, Op::kRead, [](Terms t) { return t.column_span + t.write_latency + t.ccd_l + t.wtr_l; }},
      {kBankGroup, Op::kWrite, Op::kWrite, [](Terms t) { return t.column_span + t.ccd_l; }},
      {kRank, Op::kWrite, Op::kRead, [](Terms t) { return t.write_end + t.wtr_s; }, Reason::kTurnaround},
      {kOtherRanks, Op::kWrite, Op::kRead, [](Terms t) { return t.write_end + t.rtrs - t.read_latency; },
       Reason::kRankSwitch},
      {kOtherRanks, Op::kWrite, Op::kWrite, [](Terms t) { return t.column_span + t.burst + t.rtrs; },
       Reason::kRankSwitch},

      {kBank, Op::kRefresh, Op::kActivate, [](Terms t) { return std::int64_t{t.rfc_pb}; }},
      {kBank, Op::kRefreshRank, Op::kActivate, [](Terms t) { return std::int64_t{t.rfc_ab}; }},
  });
}();

/// Returns, for each constraint of kDramConstraints, its minimum distance in cycles for a DRAM configuration
/// (configs/dram/).
inline std::array<std::int64_t, kDramConstraints.size()> constraint_cycles(const DramConfig& config) {
  std::array<std::int64_t, kDramConstraints.size()> cycles{};
  const DramTerms terms(config);
  for (std::size_t i = 0; i < cycles.size(); ++i) cycles[i] = kDramConstraints[i].cycles(terms);
  return cycles;
}

}  // namespace hw
