#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hw_models/dram/dram_config.h"
#include "sim/unit_report.h"

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

/// DRAM commands in the order in which a scheduler prefers them. kColumn represents all the read commands, or all the
/// write commands, that transfer one line.
enum class DramCommand : std::uint8_t { kColumn, kActivate, kPrecharge };

/// Reservation table of a DRAM channel's command bus and data bus. It has a 64-bit mask for each kind of command. The
/// mask marks the coming cycles in which such a command cannot start because it would conflict with a booked one.
///
/// 1. The conflicts between each pair of command kinds are precomputed, so queries and bookings need no loops over
/// cycles.
/// 2. Other commands can be booked in the gaps between the bursts of a line.
/// 3. If tAAD is not 0, an activate is split into ACT-1 and ACT-2, which follows at most tAAD later. A read or write
/// may take the cycle of a booked ACT-2, which then moves to a later cycle. No other ACT-1 is issued until the
/// pending ACT-2 has been issued.
class CommandCalendar {
 public:
  using Cycle = std::uint64_t;

  /// `bursts_per_line`: bursts that transfer a line. `commands_per_line`: column commands that start these bursts.
  CommandCalendar(const DramTiming& timing, std::uint32_t bursts_per_line, std::uint32_t commands_per_line)
      : half_activate_(timing.aad == 0 ? 0 : timing.ca_activate / 2),
        aad_(timing.aad),
        command_bus_{
            block_pattern(commands_per_line, timing.ca_column, timing.ccd_l * (bursts_per_line / commands_per_line)),
            block_pattern(1, half_activate_ == 0 ? timing.ca_activate : half_activate_, 0),
            block_pattern(1, timing.ca_precharge, 0),
            (block_pattern(commands_per_line, timing.ca_column, timing.ccd_l * (bursts_per_line / commands_per_line))
             << timing.wck_sync) |
                block_pattern(1, timing.wck_sync, 0)},
        data_bus_(block_pattern(bursts_per_line, timing.ccd_s, timing.ccd_l)) {
    for (std::size_t booked = 0; booked < kKinds; ++booked) {
      for (std::size_t asked = 0; asked < kKinds; ++asked)
        forbids_[booked][asked] = conflict_distances(command_bus_[booked], command_bus_[asked]);
    }
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      act2_conflicts_[asked] = conflicting_starts(command_bus_[asked], block_pattern(1, half_activate_, 0) << kLatest);
    const std::uint64_t data_after_cas = data_bus_ << timing.wck_sync;
    for (const std::size_t kind : {kColumn, kSync}) {
      const std::uint64_t data = kind == kSync ? data_after_cas : data_bus_;
      forbids_data_[kind == kSync] = conflicting_starts(data_bus_, data);
      forbids_[kind][kColumn] |= conflicting_starts(data_bus_, data);
      forbids_[kind][kSync] |= conflicting_starts(data_after_cas, data);
    }
  }

  /// Returns the first cycle at or after `from` in which the DRAM command can start without a conflict on either bus.
  Cycle first_free_cycle(DramCommand command, Cycle from) const {
    if (command != DramCommand::kActivate) return first_free_cycle(index_of(command), from);
    if (half_activate_ == 0) return from + cycles_until_free(mask_relative_to(blocked_[kActivate], from));
    from = std::max(from, act2_end_);
    std::uint64_t blocked = mask_relative_to(blocked_[kActivate], from);
    std::uint64_t no_second = ~std::uint64_t{0};
    for (std::uint32_t d = half_activate_; d <= aad_; ++d) no_second &= blocked >> d;
    return from + cycles_until_free(blocked | no_second);
  }
  /// Returns the first cycle at or after `from` in which a CAS (LPDDR5: starts the data clock WCK) and the read or
  /// write that follows it can start without a conflict.
  Cycle first_cycle_for_cas_and_column(Cycle from) const { return first_free_cycle(kSync, from); }
  /// True if the DRAM data bus is free for all bursts of a line whose first burst starts at cycle `at`.
  bool is_data_bus_free(Cycle at) const { return (mask_relative_to(blocked_data_, at) & 1) == 0; }

  /// Books a DRAM command that starts at cycle `at`. Cycles before `at` can no longer be queried.
  void book_command(DramCommand command, Cycle at) {
    book_kind(index_of(command), at);
    if (command != DramCommand::kActivate || half_activate_ == 0) return;
    act2_until_ = at + aad_;
    act2_end_ = at + 2 * half_activate_ + cycles_until_free(blocked_[kActivate] >> half_activate_);
    assert(act2_end_ <= act2_until_ + half_activate_);
  }
  /// Books, at cycle `at`, an LPDDR5 CAS command (it starts the data clock WCK) and the read or write that follows it.
  void book_cas_and_column(Cycle at) { book_kind(kSync, at); }

 private:
  static constexpr std::size_t kColumn = 0, kActivate = 1, kPrecharge = 2, kSync = 3, kKinds = 4;
  /// In the masks `act2_conflicts_`, the bit for the cycle of the ACT-2, the second half of an activate. Must exceed
  /// the cycles from a command to any ACT-2 with which the command can conflict.
  static constexpr std::uint32_t kLatest = 32;

  static constexpr std::size_t index_of(DramCommand command) { return static_cast<std::size_t>(command); }
  /// Returns the number of cycles until the first cycle that is not blocked. Bit n of `blocked_mask` is set if the nth
  /// cycle from now is blocked.
  static Cycle cycles_until_free(std::uint64_t blocked_mask) {
    return static_cast<Cycle>(std::countr_one(blocked_mask));
  }

  Cycle first_free_cycle(std::size_t kind, Cycle from) const {
    std::uint64_t blocked = mask_relative_to(blocked_[kind], from);
    Cycle at = from + cycles_until_free(blocked);
    while (conflicts_with_act2(kind, at) && !can_displace_act2(kind, at)) {
      blocked |= std::uint64_t{1} << (at - from);
      at = from + cycles_until_free(blocked);
    }
    return at;
  }
  /// True if a command that starts at cycle `at` would occupy the command bus in a cycle of the pending ACT-2.
  bool conflicts_with_act2(std::size_t kind, Cycle at) const {
    return at < act2_end_ && ((act2_conflicts_[kind] >> (kLatest + at + half_activate_ - act2_end_)) & 1) != 0;
  }
  bool can_displace_act2(std::size_t kind, Cycle at) const {
    return kind != kPrecharge && at + half_activate_ <= act2_end_ && act2_cycle_if_booked(kind, at) <= act2_until_;
  }
  /// Returns the cycle to which the pending ACT-2 moves if a command of kind `kind`, booked at cycle `at`, displaces
  /// it.
  Cycle act2_cycle_if_booked(std::size_t kind, Cycle at) const {
    return at + cycles_until_free(mask_relative_to(blocked_[kActivate], at) | forbids_[kind][kActivate]);
  }
  void book_kind(std::size_t kind, Cycle at) {
    if (conflicts_with_act2(kind, at)) act2_end_ = act2_cycle_if_booked(kind, at) + half_activate_;
    for (std::size_t asked = 0; asked < kKinds; ++asked)
      blocked_[asked] = mask_relative_to(blocked_[asked], at) | forbids_[kind][asked];
    blocked_data_ = mask_relative_to(blocked_data_, at);
    if (kind == kColumn || kind == kSync) blocked_data_ |= forbids_data_[kind == kSync];
    base_ = at;
  }
  /// Returns a mask of the start cycles at which a command with the bus pattern `asked_pattern` conflicts with the
  /// booked bus cycles in `booked_pattern`.
  static std::uint64_t conflicting_starts(std::uint64_t asked_pattern, std::uint64_t booked_pattern) {
    std::uint64_t all = 0;
    for (; asked_pattern != 0; asked_pattern &= asked_pattern - 1)
      all |= booked_pattern >> std::countr_zero(asked_pattern);
    return all;
  }
  /// Returns the mask of the bus cycles that a command occupies: `count` blocks of `length` cycles, `stride` apart.
  static constexpr std::uint64_t block_pattern(std::uint32_t count, std::uint32_t length, std::uint32_t stride) {
    std::uint64_t pattern = 0;
    for (std::uint32_t i = 0; i < count; ++i) pattern |= ((std::uint64_t{1} << length) - 1) << (i * stride);
    return pattern;
  }
  /// Returns a mask of conflicting distances: bit d is set if a command with the bus pattern `asked_pattern` conflicts
  /// with a command of pattern `booked_pattern` that started d cycles earlier.
  static constexpr std::uint64_t conflict_distances(std::uint64_t booked_pattern, std::uint64_t asked_pattern) {
    std::uint64_t distances = 0;
    for (std::uint32_t d = 0; d < 64; ++d) {
      if (((booked_pattern >> d) & asked_pattern) != 0) distances |= std::uint64_t{1} << d;
    }
    return distances;
  }
  std::uint64_t mask_relative_to(std::uint64_t mask, Cycle from) const {
    return from - base_ >= 64 ? 0 : mask >> (from - base_);
  }

  const std::uint32_t half_activate_;  ///< cycles of each of ACT-1 and ACT-2; 0: activates are not split
  const std::uint32_t aad_;
  /// Mask of the command bus cycles that each kind of command occupies.
  const std::array<std::uint64_t, kKinds> command_bus_;
  const std::uint64_t data_bus_;  ///< mask of the data bus cycles that a line occupies
  Cycle base_ = 0;
  /// For each kind of command, mask of the cycles from `base_` on in which such a command cannot start.
  std::array<std::uint64_t, kKinds> blocked_{};
  std::uint64_t blocked_data_ = 0;
  Cycle act2_end_ = 0;    ///< first cycle after the last booked ACT-2; 0: none yet
  Cycle act2_until_ = 0;  ///< latest cycle to which the last booked ACT-2 may move
  std::array<std::array<std::uint64_t, kKinds>, kKinds> forbids_{};
  /// For a booked read or write, mask of the cycles in which the data of another line cannot start. [0]: without a CAS
  /// before the command; [1]: with a CAS.
  std::array<std::uint64_t, 2> forbids_data_{};
  /// For each kind of command, mask of the start cycles that conflict with an ACT-2. Bit kLatest is the cycle of the
  /// ACT-2.
  std::array<std::uint64_t, kKinds> act2_conflicts_{};
};

/// Timing state of the banks and buses of one DRAM channel, which determines when a command may be issued. The state is
/// the earliest allowed cycle of each operation, so no counters are decremented.
class DramDevice {
 public:
  using Cycle = std::uint64_t;
  static constexpr std::uint32_t kMaxBanks = BankLanes::kMaxBanks;  ///< maximum number of banks of a channel
  static constexpr std::uint32_t kMaxRanks = 2;

  explicit DramDevice(const DramConfig& config);

  bool is_open(std::uint32_t bank) const { return ((open_ >> bank) & 1) != 0; }
  bool is_open(std::uint32_t bank, std::uint32_t row) const { return is_open(bank) && rows_[bank] == row; }

  /// Returns a mask of the DRAM banks with an open row.
  std::uint32_t open_bank_mask() const { return open_; }

  /// Returns the first cycle at or after `now` at which the DRAM device is out of power-down.
  Cycle first_awake_cycle(Cycle now) const { return std::max(now, awake_at_); }
  /// Returns the first cycle at or after `from` at which the timing constraints of the whole rank allow the command.
  Cycle earliest_rank_cycle(DramCommand command, std::uint32_t rank, bool write, Cycle from) const {
    if (command == DramCommand::kActivate) return rank_[rank].next_activate_cycle(from, t_);
    return command == DramCommand::kColumn ? std::max(from, rank_[rank].at[index_of(column_operation(write))]) : from;
  }
  /// Returns a mask of the banks whose own timing constraints allow the command in the given cycle. Ignores constraints
  /// of the rank and the buses.
  template <DramCommand kCommand>
  std::uint32_t ready_bank_mask(bool write, Cycle cycle) const {
    const BankLanes& at = bank_at_[index_of(operation_of(kCommand, write))];
    return kCommand == DramCommand::kColumn ? at.banks_with_both_at_most(group_at_[write], cycle)
                                            : at.banks_with_value_at_most(cycle);
  }
  /// Returns the first cycle at which the command is allowed in any bank of the mask `bank_mask`. Ignores constraints
  /// of the rank and the buses.
  template <DramCommand kCommand>
  Cycle first_ready_cycle(std::uint32_t bank_mask, bool write) const {
    const BankLanes& at = bank_at_[index_of(operation_of(kCommand, write))];
    return kCommand == DramCommand::kColumn ? at.min_of_maxima_with(group_at_[write], bank_mask) : at.min_of(bank_mask);
  }
  /// Returns the first cycle at or after `ready` at which the command bus and data bus are free for the command. If the
  /// data clock WCK is stopped, a read or write needs a CAS first. The result is then the cycle of the CAS.
  Cycle first_bus_slot(DramCommand command, std::uint32_t rank, Cycle ready) const {
    const Rank& of = rank_[rank];
    Cycle free = calendar_.first_free_cycle(command, ready);
    if (command == DramCommand::kColumn && t_.wck_sync != 0 && free >= of.wck_stops_at)
      return calendar_.first_cycle_for_cas_and_column(std::max(ready, of.wck_stops_at));
    if (command == DramCommand::kActivate && t_.pbr2act != 0) {
      for (Cycle allowed = of.next_activate_cycle(free, t_); allowed != free;
           allowed = of.next_activate_cycle(free, t_)) {
        free = calendar_.first_free_cycle(command, allowed);
      }
    }
    return free;
  }

  /// Returns the timing constraint that delays a DRAM command until its earliest cycle, `at`.
  DramCycleReason wait_reason(DramCommand command, std::uint32_t bank, bool write, Cycle at) const;

  void activate_row(std::uint32_t bank, std::uint32_t row, Cycle now);
  void precharge_bank(std::uint32_t bank, Cycle now);
  /// Closes the bank's row after its last read or write, without a precharge command on the bus.
  void auto_precharge(std::uint32_t bank) { close_bank(bank, earliest_cycle(DramOp::kPrecharge, bank)); }
  /// Issues the read or write commands of one line, after a CAS if the data clock WCK is stopped. Returns the cycle in
  /// which the line's data begin.
  Cycle read_line(std::uint32_t bank, Cycle now);
  Cycle write_line(std::uint32_t bank, Cycle now);
  /// Returns the number of cycles from the beginning of a line's first burst to the end of its last burst.
  Cycle line_transfer_cycles() const { return column_span_ + t_.burst; }
  /// Calls f(begin, end) for each interval in which a line occupies the DRAM data bus. `data`: start of its data.
  void for_each_burst(Cycle data, auto&& f) const {
    if (t_.ccd_l == t_.burst) return f(data, data + line_transfer_cycles());
    for (Cycle begin = data; begin <= data + column_span_; begin += t_.ccd_l) f(begin, begin + t_.burst);
  }

  /// Returns a mask of the banks of a DRAM rank.
  std::uint32_t bank_mask_of_rank(std::uint32_t rank) const { return rank_banks_ << (rank << rank_shift_); }
  /// Returns a mask of the banks that a per-bank refresh command for `bank` refreshes together.
  std::uint32_t refresh_bank_mask_of(std::uint32_t bank) const { return refresh_set_ << bank; }
  /// Returns a mask of the banks that a per-bank refresh command may name. If banks are refreshed in pairs, it is the
  /// lower bank of each pair.
  std::uint32_t refresh_command_bank_mask() const { return refresh_leaders_; }

  /// Closes the banks of the mask `bank_mask` and refreshes them together, as soon as timing allows from cycle `due`
  /// on.
  void refresh_banks(std::uint32_t bank_mask, Cycle due);
  /// Closes all banks of the rank and refreshes the rank, as soon as timing allows at or after cycle `due`.
  void refresh_rank(std::uint32_t rank, Cycle due);
  /// Closes the banks of the mask `bank_mask` together, as soon as timing allows at or after cycle `from`. Returns the
  /// cycle at which all are precharged.
  Cycle precharge_banks(std::uint32_t bank_mask, Cycle from);
  /// Takes the DRAM device out of power-down. `at`: cycle of the first command that is allowed.
  void leave_power_down(Cycle at) { awake_at_ = at; }

  std::uint32_t open_bank_count() const;
  std::uint64_t turnaround_count() const { return turnarounds_; }
  /// Returns the number of cycles before `until` in which a rank had an open row, summed over ranks. `until` must not
  /// decrease between calls.
  Cycle cycles_with_open_row(Cycle until);

 private:
  static constexpr std::size_t index_of(DramOp op) { return static_cast<std::size_t>(op); }
  static constexpr DramOp column_operation(bool write) { return write ? DramOp::kWrite : DramOp::kRead; }
  static constexpr DramOp operation_of(DramCommand command, bool write) {
    if (command == DramCommand::kColumn) return column_operation(write);
    return command == DramCommand::kActivate ? DramOp::kActivate : DramOp::kPrecharge;
  }
  Cycle& earliest_cycle(DramOp op, std::uint32_t bank) { return bank_at_[index_of(op)][bank]; }
  Cycle earliest_cycle(DramOp op, std::uint32_t bank) const { return bank_at_[index_of(op)][bank]; }
  std::uint32_t rank_of(std::uint32_t bank) const { return bank >> rank_shift_; }
  /// Returns a mask of the DRAM banks in the same bank group as `bank`.
  std::uint32_t bank_group_mask_of(std::uint32_t bank) const { return group_banks_ << (bank & group_mask_); }
  template <DramOp kFrom>
  void apply_constraints(std::uint32_t bank, Cycle now);
  void close_bank(std::uint32_t bank, Cycle now);
  Cycle reserve_burst_sequence(std::uint32_t bank, bool write, Cycle now);
  Cycle first_precharged_cycle(std::uint32_t bank_mask, Cycle from) const;
  template <DramOp kRefresh>
  void start_refresh(std::uint32_t bank_mask, Cycle begin);

  struct Rank {
    std::array<Cycle, 3> at{};                ///< earliest cycle of a read, write or activate in this rank, by DramOp
    std::array<DramCycleReason, 3> reason{};  ///< timing constraint that sets each earliest cycle in `at`
    /// For each of the last four activates, the cycle at which it leaves the tFAW window.
    std::array<Cycle, 4> four_activates{};
    std::uint32_t oldest_activate = 0;
    Cycle active = 0;  ///< number of cycles with an open row in this rank before `active_since`
    Cycle active_since = 0, active_until = 0;

    Cycle refreshed_at = 0;  ///< start of the rank's last per-bank refresh; 0: none yet
    Cycle wck_stops_at = 0;  ///< cycle at which the data clock WCK stops; a read or write from then on needs a CAS

    Cycle next_activate_cycle(Cycle from, const DramTiming& timing) const {
      Cycle activate = std::max({from, at[index_of(DramOp::kActivate)], four_activates[oldest_activate]});
      if (timing.pbr2act == 0 || refreshed_at == 0) return activate;
      if (activate + timing.pbr2act > refreshed_at) activate = std::max(activate, refreshed_at + timing.pbr2act);
      const Cycle window = refreshed_at + timing.faw;
      if (!timing.pbr_in_faw || activate < refreshed_at || activate >= window) return activate;
      return std::max(activate, std::min(window, four_activates[(oldest_activate + 1) % 4]));
    }
    void raise_earliest_cycle(DramOp op, Cycle cycle, DramCycleReason waits_for) {
      if (cycle <= at[index_of(op)]) return;
      at[index_of(op)] = cycle;
      reason[index_of(op)] = waits_for;
    }
    void add_to_activate_window(Cycle leaves_window_at) {
      four_activates[oldest_activate] = leaves_window_at;
      oldest_activate = (oldest_activate + 1) % 4;
    }
  };

  const DramTiming t_;
  const std::array<std::int64_t, kDramConstraints.size()> constraint_cycles_;
  const std::uint32_t ranks_, rank_shift_;
  const std::uint32_t group_mask_;   ///< a bank's number ANDed with this is the first bank of its bank group
  const std::uint32_t group_banks_;  ///< mask of the banks of the first bank group
  const std::uint32_t rank_banks_;   ///< mask of the banks of the first rank
  const std::uint32_t refresh_set_;
  const std::uint32_t refresh_leaders_;
  const Cycle column_span_;  ///< cycles from the first to the last column command of a line

  std::uint32_t open_ = 0;  ///< mask of the banks with an open row
  std::array<std::uint32_t, kMaxBanks> rows_{};
  /// Earliest cycle of a read, write, activate and precharge in each bank, by DramOp.
  std::array<BankLanes, 4> bank_at_;
  std::array<DramCycleReason, kMaxBanks> activate_wait_reason_{};  ///< for each closed bank, reason why it cannot be
                                                                   ///< activated yet
  std::array<BankLanes, 2> group_at_;  ///< earliest read [0] and write [1] that the bank group allows, for each bank
  std::array<Rank, kMaxRanks> rank_{};
  Cycle awake_at_ = 0;
  CommandCalendar calendar_;
  bool last_was_write_ = false;
  std::uint64_t turnarounds_ = 0;
};

}  // namespace hw
