#include "hw_models/dram/dram_device.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

namespace hw {

using enum DramCommand;

namespace {

std::uint32_t log2_of(std::uint32_t number) { return static_cast<std::uint32_t>(std::countr_zero(number)); }
/// Returns a mask of DRAM banks 0, `stride`, 2 * `stride` and so on below `bank_count`.
std::uint32_t strided_mask(std::uint32_t stride, std::uint32_t bank_count) {
  std::uint32_t mask = 0;
  for (std::uint32_t bank = 0; bank < bank_count; bank += stride) mask |= 1U << bank;
  return mask;
}
std::uint32_t lowest_bits_mask(std::uint32_t count) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1);
}

/// Returns the distance between the numbers of two banks that are refreshed together: half the number of bank groups,
/// or half the number of banks if there are no groups.
std::uint32_t refresh_pair_distance(const DramOrganisation& organisation) {
  return organisation.bank_groups > 1 ? organisation.bank_groups / 2 : organisation.banks / 2;
}

std::uint32_t lower_bank_mask(const DramOrganisation& organisation) {
  std::uint32_t banks = 0;
  for (std::uint32_t bank = 0; bank < organisation.all_banks(); ++bank) {
    if (organisation.refresh_banks == 1 || (bank & refresh_pair_distance(organisation)) == 0) banks |= 1U << bank;
  }
  return banks;
}

BankLanes empty_lanes(const DramConfig& config) { return BankLanes(config.organisation.all_banks()); }

}  // namespace

DramDevice::DramDevice(const DramConfig& c)
    : t_(c.timing),
      constraint_cycles_(constraint_cycles(c)),
      ranks_(c.organisation.ranks),
      rank_shift_(log2_of(c.organisation.banks)),
      group_mask_((c.organisation.bank_groups - 1) | ~(c.organisation.banks - 1)),
      group_banks_(strided_mask(c.organisation.bank_groups, c.organisation.banks)),
      rank_banks_(lowest_bits_mask(c.organisation.banks)),
      refresh_set_(c.organisation.refresh_banks == 1 ? 1 : 1 | 1U << refresh_pair_distance(c.organisation)),
      refresh_leaders_(lower_bank_mask(c.organisation)),
      column_span_(Cycle{c.bursts_per_line() - 1} * c.timing.ccd_l),
      bank_at_{empty_lanes(c), empty_lanes(c), empty_lanes(c), empty_lanes(c)},
      group_at_{empty_lanes(c), empty_lanes(c)},
      calendar_(c.timing, c.bursts_per_line(), c.commands_per_line()) {
  assert(c.organisation.all_banks() <= kMaxBanks && c.organisation.ranks <= kMaxRanks);
}

DramCycleReason DramDevice::wait_reason(DramCommand command, std::uint32_t bank, bool write, Cycle at) const {
  const bool by_bank = at == this->earliest_cycle(operation_of(command, write), bank);
  const Rank& rank = rank_[rank_of(bank)];
  if (at == awake_at_ && at != 0) return DramCycleReason::kPowerDown;
  switch (command) {
    case kColumn:
      if (by_bank) return DramCycleReason::kActivate;
      if (at == rank.at[index_of(column_operation(write))]) return rank.reason[index_of(column_operation(write))];
      if (at == group_at_[write][bank])
        return last_was_write_ && !write ? DramCycleReason::kTurnaround : DramCycleReason::kColumn;
      return calendar_.is_data_bus_free(at - 1) ? DramCycleReason::kCommandBus : DramCycleReason::kColumn;
    case kActivate:
      if (by_bank) return activate_wait_reason_[bank];
      return at == rank.next_activate_cycle(at - 1, t_) ? DramCycleReason::kActivate : DramCycleReason::kCommandBus;
    case kPrecharge:
      return by_bank ? DramCycleReason::kRowConflict : DramCycleReason::kCommandBus;
  }
  return DramCycleReason::kIdle;
}

/// Applies all DRAM timing constraints that follow from an operation `kFrom` of the bank at cycle `now`: raises the
/// earliest cycles of later operations. The loop over constraints is unrolled at compile time.
template <DramOp kFrom>
inline void DramDevice::apply_constraints(std::uint32_t bank, Cycle now) {
  const std::uint32_t own_rank = rank_of(bank);
  const auto apply = [&]<std::size_t kRow>() {
    constexpr const DramConstraint& row = kDramConstraints[kRow];
    if constexpr (row.from == kFrom) {
      const Cycle bound = now + static_cast<Cycle>(constraint_cycles_[kRow]);
      if constexpr (row.scope == DramScope::kBank) {
        earliest_cycle(row.to, bank) = std::max(earliest_cycle(row.to, bank), bound);
      } else if constexpr (row.scope == DramScope::kBankGroup) {
        group_at_[row.to == DramOp::kWrite].raise_to_at_least(bank_group_mask_of(bank), bound);
      } else if constexpr (row.count > 1) {
        rank_[own_rank].add_to_activate_window(bound);
      } else if constexpr (row.scope == DramScope::kRank) {
        rank_[own_rank].raise_earliest_cycle(row.to, bound, row.reason);
      } else {
        const auto later = std::max(static_cast<std::int64_t>(bound), std::int64_t{0});
        for (std::uint32_t r = 0; r < ranks_; ++r) {
          if (r != own_rank) rank_[r].raise_earliest_cycle(row.to, static_cast<Cycle>(later), row.reason);
        }
      }
    }
  };
  [&]<std::size_t... kRows>(std::index_sequence<kRows...>) { (apply.template operator()<kRows>(), ...); }
  (std::make_index_sequence<kDramConstraints.size()>());
}

void DramDevice::activate_row(std::uint32_t bank, std::uint32_t row, Cycle now) {
  Rank& rank = rank_[rank_of(bank)];
  if ((open_ & bank_mask_of_rank(rank_of(bank))) == 0 && now > rank.active_until) {
    rank.active += rank.active_until - rank.active_since;
    rank.active_since = now;
  }
  open_ |= 1U << bank;
  rows_[bank] = row;
  apply_constraints<DramOp::kActivate>(bank, now);
  calendar_.book_command(kActivate, now);
}

void DramDevice::precharge_bank(std::uint32_t bank, Cycle now) {
  calendar_.book_command(kPrecharge, now);
  close_bank(bank, now);
}

void DramDevice::close_bank(std::uint32_t bank, Cycle now) {
  open_ &= ~(1U << bank);
  apply_constraints<DramOp::kPrecharge>(bank, now);
  activate_wait_reason_[bank] = DramCycleReason::kRowConflict;
  Rank& rank = rank_[rank_of(bank)];
  rank.active_until = std::max(rank.active_until, now);
}

DramDevice::Cycle DramDevice::read_line(std::uint32_t bank, Cycle now) {
  now = reserve_burst_sequence(bank, false, now);
  apply_constraints<DramOp::kRead>(bank, now);
  const Cycle data = now + t_.rl + t_.dqsck;
  rank_[rank_of(bank)].wck_stops_at = data + line_transfer_cycles() + t_.wck_post;
  return data;
}

DramDevice::Cycle DramDevice::write_line(std::uint32_t bank, Cycle now) {
  now = reserve_burst_sequence(bank, true, now);
  apply_constraints<DramOp::kWrite>(bank, now);
  const Cycle data = now + t_.wl + t_.dqss;
  rank_[rank_of(bank)].wck_stops_at = data + line_transfer_cycles() + t_.wck_post;
  return data;
}

/// Books the column commands of one line from cycle `now` on, after a CAS if the data clock WCK is stopped. Returns the
/// cycle of the first column command.
DramDevice::Cycle DramDevice::reserve_burst_sequence(std::uint32_t bank, bool write, Cycle now) {
  turnarounds_ += write != last_was_write_;
  last_was_write_ = write;
  if (t_.wck_sync != 0 && now >= rank_[rank_of(bank)].wck_stops_at) {
    calendar_.book_cas_and_column(now);
    return now + t_.wck_sync;
  }
  calendar_.book_command(kColumn, now);
  return now;
}

void DramDevice::refresh_banks(std::uint32_t bank_mask, Cycle due) {
  for (std::uint32_t left = bank_mask & open_; left != 0; left &= left - 1) {
    const std::uint32_t bank = log2_of(left);
    close_bank(bank, std::max(due, earliest_cycle(DramOp::kPrecharge, bank)));
  }
  Rank& rank = rank_[rank_of(log2_of(bank_mask))];
  const Cycle begin = first_precharged_cycle(bank_mask, due);
  rank.refreshed_at =
      t_.pbr2act == 0
          ? begin
          : std::max({begin, rank.at[index_of(DramOp::kActivate)], rank.four_activates[rank.oldest_activate]});
  start_refresh<DramOp::kRefresh>(bank_mask, rank.refreshed_at);
}

void DramDevice::refresh_rank(std::uint32_t rank, Cycle due) {
  const std::uint32_t banks = bank_mask_of_rank(rank);
  start_refresh<DramOp::kRefreshRank>(banks, first_precharged_cycle(banks, precharge_banks(banks, due)));
}

/// Returns the first cycle at or after `from` at which all banks of the mask `bank_mask` are precharged.
DramDevice::Cycle DramDevice::first_precharged_cycle(std::uint32_t bank_mask, Cycle from) const {
  for (std::uint32_t left = bank_mask; left != 0; left &= left - 1)
    from = std::max(from, earliest_cycle(DramOp::kActivate, log2_of(left)));
  return from;
}

template <DramOp kRefresh>
void DramDevice::start_refresh(std::uint32_t bank_mask, Cycle begin) {
  for (std::uint32_t left = bank_mask; left != 0; left &= left - 1) {
    apply_constraints<kRefresh>(log2_of(left), begin);
    activate_wait_reason_[log2_of(left)] = DramCycleReason::kRefresh;
  }
}

DramDevice::Cycle DramDevice::precharge_banks(std::uint32_t bank_mask, Cycle from) {
  const std::uint32_t open = bank_mask & open_;
  const Cycle closed = rank_[rank_of(log2_of(bank_mask))].active_until;  // may be in the future
  if (open == 0) return closed == 0 ? from : std::max(from, closed + t_.rp);
  Cycle begin = std::max(from, closed);
  for (std::uint32_t left = open; left != 0; left &= left - 1)
    begin = std::max(begin, earliest_cycle(DramOp::kPrecharge, log2_of(left)));
  for (std::uint32_t left = open; left != 0; left &= left - 1) close_bank(log2_of(left), begin);
  return begin + t_.rp_ab;
}

std::uint32_t DramDevice::open_bank_count() const { return static_cast<std::uint32_t>(std::popcount(open_)); }

DramDevice::Cycle DramDevice::cycles_with_open_row(Cycle until) {
  Cycle sum = 0;
  for (std::uint32_t r = 0; r < ranks_; ++r) {
    Rank& rank = rank_[r];
    // The last row of the rank may be closed at a future cycle, because a refresh closes rows as soon as timing allows.
    const Cycle end = (open_ & bank_mask_of_rank(r)) != 0 ? until : std::min(until, rank.active_until);
    if (end > rank.active_since) {
      rank.active += end - rank.active_since;
      rank.active_since = end;
    }
    sum += rank.active;
  }
  return sum;
}

}  // namespace hw
