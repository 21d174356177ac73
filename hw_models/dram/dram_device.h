#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>

#include "hw_models/dram/bank_lanes.h"
#include "hw_models/dram/dram_config.h"
#include "hw_models/dram/dram_timing_table.h"

namespace hw {

/// Commands in order of preference. kColumn is the sequence of reads, or of writes, that moves one line.
enum class DramCommand : std::uint8_t { kColumn, kActivate, kPrecharge };

/// Reservation table of the command bus and the data bus. For each kind of command, a bit mask marks the next 64 cycles
/// in which it cannot start because it would conflict with something booked.
///
/// 1. The conflicts between each pair of kinds are precomputed, so queries and bookings need no loops.
/// 2. Other commands fit into the gaps of a line's burst sequence.
/// 3. With tAAD an activate is ACT-1 and, at most tAAD later, ACT-2. ACT-2 moves to another slot for reads and writes
/// while it can. No ACT-1 is issued before that ACT-2.
class CommandCalendar {
 public:
  using Cycle = std::uint64_t;

  /// A line takes `bursts` bursts, moved by `commands` column commands.
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
        forbids_[booked][asked] = conflict_distances(command_bus_[booked], command_bus_[asked]);
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

  /// Returns the first cycle at or after `from` at which the command conflicts with nothing booked.
  Cycle first_free(DramCommand command, Cycle from) const {
    if (command != DramCommand::kActivate) return first_free(index(command), from);
    if (half_ == 0) return from + distance_to_free(ahead(blocked_[kActivate], from));
    from = std::max(from, second_at_ + half_);
    std::uint64_t blocked = ahead(blocked_[kActivate], from);
    std::uint64_t no_second = ~std::uint64_t{0};
    for (std::uint32_t d = half_; d <= aad_; ++d) no_second &= blocked >> d;
    return from + distance_to_free(blocked | no_second);
  }
  /// Returns the first cycle at or after `from` at which a CAS and its column command fit.
  Cycle first_free_with_sync(Cycle from) const { return first_free(kSync, from); }
  /// True if the data bus is free for a burst sequence that starts at `at`.
  bool data_free(Cycle at) const { return (ahead(blocked_data_, at) & 1) == 0; }

  /// Books the command, and drops the cycles before `at`.
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
  static constexpr std::uint32_t kLatest =
      32;  ///< more than the cycles from a command to any ACT-2 that it can conflict with

  static constexpr std::size_t index(DramCommand command) { return static_cast<std::size_t>(command); }
  /// Returns the distance to the first start that is not blocked.
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
  /// Returns the starts at which a pattern `asked` conflicts with what is booked.
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
  /// Returns the distances, in cycles, at which a pattern `asked` conflicts with a pattern `booked` that started
  /// before.
  static constexpr std::uint64_t conflict_distances(std::uint64_t booked, std::uint64_t asked) {
    std::uint64_t distances = 0;
    for (std::uint32_t d = 0; d < 64; ++d) {
      if (((booked >> d) & asked) != 0) distances |= std::uint64_t{1} << d;
    }
    return distances;
  }
  std::uint64_t ahead(std::uint64_t mask, Cycle from) const { return from - base_ >= 64 ? 0 : mask >> (from - base_); }

  const std::uint32_t half_;  ///< cycles of ACT-1, and of ACT-2; 0: an activate is one command
  const std::uint32_t aad_;
  const std::array<std::uint64_t, kKinds> command_bus_;  ///< the pattern of each kind of command
  const std::uint64_t data_bus_;                         ///< the pattern of a line
  Cycle base_ = 0;
  std::array<std::uint64_t, kKinds> blocked_{};  ///< without the pending ACT-2
  std::uint64_t blocked_data_ = 0;
  Cycle second_at_ = 0, second_until_ = 0;  ///< slot of the last ACT-2, and the latest slot that it may take
  std::array<std::array<std::uint64_t, kKinds>, kKinds> forbids_{};
  std::array<std::uint64_t, 2> forbids_data_{};  ///< by a column command, and by one with a CAS
  std::array<std::uint64_t, kKinds> second_{};   ///< starts of each kind that conflict with an ACT-2 at bit kLatest
};

/// The banks and buses of one channel, which determine when a command may run. Its state holds earliest allowed cycles
/// of the command clock, not countdowns.
class DramDevice {
 public:
  using Cycle = std::uint64_t;
  static constexpr std::uint32_t kMaxBanks = BankLanes::kMost;  ///< banks of all ranks
  static constexpr std::uint32_t kMaxRanks = 2;

  explicit DramDevice(const DramConfig& config);

  bool is_open(std::uint32_t bank) const { return ((open_ >> bank) & 1) != 0; }
  bool is_open(std::uint32_t bank, std::uint32_t row) const { return is_open(bank) && rows_[bank] == row; }

  /// Banks with an open row, as a mask.
  std::uint32_t open_mask() const { return open_; }

  /// Returns the first cycle at or after `now` at which the device is not in power-down.
  Cycle awake(Cycle now) const { return std::max(now, awake_at_); }
  /// Returns the first cycle at or after `from` at which the rank allows the command in any of its banks.
  Cycle rank_ready(DramCommand command, std::uint32_t rank, bool write, Cycle from) const {
    if (command == DramCommand::kActivate) return rank_[rank].next_activate(from, t_);
    return command == DramCommand::kColumn ? std::max(from, rank_[rank].at[index(column(write))]) : from;
  }
  /// Returns the first cycle at which bank and rank allow the command. The buses are not considered.
  Cycle ready(DramCommand command, std::uint32_t bank, bool write, Cycle rank_ready) const {
    const Cycle ready = std::max(rank_ready, at(op_of(command, write), bank));
    if (command != DramCommand::kColumn) return ready;
    return std::max(ready, group_at_[write][bank]);
  }
  /// Returns the banks that allow the command in cycle `by`, as a mask. Rank and buses are not considered.
  template <DramCommand kCommand>
  std::uint32_t ready_banks(bool write, Cycle by) const {
    const BankLanes& at = bank_at_[index(op_of(kCommand, write))];
    return kCommand == DramCommand::kColumn ? at.both_up_to(group_at_[write], by) : at.up_to(by);
  }
  /// Returns the first cycle at which one of these banks allows the command. Rank and buses are not considered.
  template <DramCommand kCommand>
  Cycle first_ready(std::uint32_t banks, bool write) const {
    const BankLanes& at = bank_at_[index(op_of(kCommand, write))];
    return kCommand == DramCommand::kColumn ? at.min_of_max(group_at_[write], banks) : at.least(banks);
  }
  /// Returns the first cycle at or after `ready` at which the buses are free for the command. For a read or write with
  /// WCK stopped it is the cycle of the preceding CAS.
  Cycle slot(DramCommand command, std::uint32_t rank, Cycle ready) const {
    const Rank& of = rank_[rank];
    Cycle free = calendar_.first_free(command, ready);
    if (command == DramCommand::kColumn && t_.wck_sync != 0 && free >= of.wck_stops_at)
      return calendar_.first_free_with_sync(std::max(ready, of.wck_stops_at));
    if (command == DramCommand::kActivate && t_.pbr2act != 0) {
      for (Cycle allowed = of.next_activate(free, t_); allowed != free; allowed = of.next_activate(free, t_)) {
        free = calendar_.first_free(command, allowed);
      }
    }
    return free;
  }

  /// Returns the reason why the command cannot run before `at`, its earliest cycle. The reason holds for all cycles
  /// until then.
  DramCycleReason reason(DramCommand command, std::uint32_t bank, bool write, Cycle at) const;

  void activate(std::uint32_t bank, std::uint32_t row, Cycle now);
  void precharge(std::uint32_t bank, Cycle now);
  /// Precharges the bank with its last read or write, which takes no command slot.
  void auto_precharge(std::uint32_t bank) { close(bank, at(DramOp::kPrecharge, bank)); }
  /// Reads or writes one line, with a CAS before it if WCK is stopped. Returns the cycle of the first data.
  Cycle read(std::uint32_t bank, Cycle now);
  Cycle write(std::uint32_t bank, Cycle now);
  /// Cycles from the first data of a line to the end of its last burst.
  Cycle data_cycles() const { return train_length_ + t_.burst; }
  /// Calls f(begin, end) for each interval in which a line whose data begin at `data` occupies the data bus.
  void each_burst(Cycle data, auto&& f) const {
    if (t_.ccd_l == t_.burst) return f(data, data + data_cycles());
    for (Cycle begin = data; begin <= data + train_length_; begin += t_.ccd_l) f(begin, begin + t_.burst);
  }

  /// Masks of the banks of a rank, and of the banks that a per-bank refresh takes together with `bank`.
  std::uint32_t banks_of(std::uint32_t rank) const { return rank_banks_ << (rank << rank_shift_); }
  std::uint32_t refreshed_with(std::uint32_t bank) const { return refresh_set_ << bank; }
  /// The banks by which per-bank refreshes are numbered: the lower one of each pair.
  std::uint32_t refresh_leaders() const { return refresh_leaders_; }

  /// Closes and refreshes these banks together, as soon as allowed at or after `due`.
  void refresh(std::uint32_t banks, Cycle due);
  /// Closes and refreshes the whole rank, as soon as allowed at or after `due`.
  void refresh_rank(std::uint32_t rank, Cycle due);
  /// Closes these banks together, as soon as allowed at or after `from`. Returns when all of them are precharged.
  Cycle precharge_all(std::uint32_t banks, Cycle from);
  /// Leaves power-down: the first command may run at `at`.
  void wake(Cycle at) { awake_at_ = at; }

  std::uint32_t open_banks() const;
  std::uint64_t turnarounds() const { return turnarounds_; }
  /// Returns the cycles before `until` with an open row, summed over ranks. `until` must not decrease between calls.
  Cycle active_cycles(Cycle until);

 private:
  static constexpr std::size_t index(DramOp op) { return static_cast<std::size_t>(op); }
  static constexpr DramOp column(bool write) { return write ? DramOp::kWrite : DramOp::kRead; }
  static constexpr DramOp op_of(DramCommand command, bool write) {
    if (command == DramCommand::kColumn) return column(write);
    return command == DramCommand::kActivate ? DramOp::kActivate : DramOp::kPrecharge;
  }
  Cycle& at(DramOp op, std::uint32_t bank) { return bank_at_[index(op)][bank]; }
  Cycle at(DramOp op, std::uint32_t bank) const { return bank_at_[index(op)][bank]; }
  std::uint32_t rank_of(std::uint32_t bank) const { return bank >> rank_shift_; }
  /// The banks of a bank's group, as a mask.
  std::uint32_t group_of(std::uint32_t bank) const { return group_banks_ << (bank & group_mask_); }
  template <DramOp kFrom>
  void constrain(std::uint32_t bank, Cycle now);
  void close(std::uint32_t bank, Cycle now);
  Cycle reserve_burst_sequence(std::uint32_t bank, bool write, Cycle now);
  Cycle begin_of_refresh(std::uint32_t banks, Cycle from) const;
  template <DramOp kRefresh>
  void start_refresh(std::uint32_t banks, Cycle begin);

  struct Rank {
    std::array<Cycle, 3> at{};                ///< first cycle of a read, write or activate, by DramOp
    std::array<DramCycleReason, 3> reason{};  ///< reason of each of `at`
    std::array<Cycle, 4> four_activates{};    ///< when each of the last four activates leaves the tFAW window
    std::uint32_t oldest_activate = 0;
    Cycle active = 0;  ///< cycles with an open row before `active_since`
    Cycle active_since = 0, active_until = 0;

    Cycle refreshed_at = 0;  ///< start of the last per-bank refresh; 0: none yet
    Cycle wck_stops_at = 0;  ///< WCK stops at this cycle; a later read or write needs a CAS

    Cycle next_activate(Cycle from, const DramTiming& t) const {
      Cycle activate = std::max({from, at[index(DramOp::kActivate)], four_activates[oldest_activate]});
      if (t.pbr2act == 0 || refreshed_at == 0) return activate;
      if (activate + t.pbr2act > refreshed_at) activate = std::max(activate, refreshed_at + t.pbr2act);
      const Cycle window = refreshed_at + t.faw;
      if (!t.pbr_in_faw || activate < refreshed_at || activate >= window) return activate;
      return std::max(activate, std::min(window, four_activates[(oldest_activate + 1) % 4]));
    }
    void raise(DramOp op, Cycle to, DramCycleReason why) {
      if (to <= at[index(op)]) return;
      at[index(op)] = to;
      reason[index(op)] = why;
    }
    void add_to_window(Cycle leaves_at) {
      four_activates[oldest_activate] = leaves_at;
      oldest_activate = (oldest_activate + 1) % 4;
    }
  };

  const DramTiming t_;
  const std::array<std::int64_t, kDramConstraints.size()> constraint_cycles_;
  const std::uint32_t ranks_, rank_shift_;
  const std::uint32_t group_mask_;   ///< bits of a bank's number that give the first bank of its group
  const std::uint32_t group_banks_;  ///< banks of the first group, as a mask
  const std::uint32_t rank_banks_;   ///< banks of the first rank, as a mask
  const std::uint32_t refresh_set_;
  const std::uint32_t refresh_leaders_;
  const Cycle train_length_;  ///< first to last column command of a line

  std::uint32_t open_ = 0;  ///< banks with an open row, as a mask
  std::array<std::uint32_t, kMaxBanks> rows_{};
  std::array<BankLanes, 4> bank_at_;  ///< earliest cycle in the bank, by DramOp: read, write, activate, precharge
  std::array<DramCycleReason, kMaxBanks> closed_reason_{};  ///< why an activate of the closed bank waits
  std::array<BankLanes, 2> group_at_;                       ///< earliest read and write by the bank's group
  std::array<Rank, kMaxRanks> rank_{};
  Cycle awake_at_ = 0;
  CommandCalendar calendar_;
  bool last_was_write_ = false;
  std::uint64_t turnarounds_ = 0;
};

}  // namespace hw
