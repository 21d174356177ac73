#include "hw_models/dram/dram_channel.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

namespace hw {

/// Replaces `best` if one of the given banks of a rank has a better command of kind `kCommand`. Let t be the first
/// cycle that rank and bus constraints allow. The new command serves the oldest request whose bank is ready at t, and
/// starts at t. If no bank is ready at t, t becomes the first cycle at which one is.
template <DramCommand kCommand>
[[gnu::always_inline]] inline void DramScheduler::keep_better_command(const DramQueue& queue, std::uint32_t bank_mask,
                                                                      std::uint32_t rank, bool writes, Cycle from,
                                                                      ScheduledCommand& best) const {
  if (bank_mask == 0) return;
  const auto none_is_better = [&](Cycle at) { return best < ScheduledCommand(at, kCommand, 0, 0); };
  const Cycle rank_ready = device_.earliest_rank_cycle(kCommand, rank, writes, from);
  if (none_is_better(rank_ready)) return;
  const auto take = [&](Cycle at, std::uint64_t positions) {
    const auto oldest = static_cast<std::uint32_t>(std::countr_zero(positions));
    best = std::min(best, ScheduledCommand(at, kCommand, oldest, queue.at(oldest).address.bank));
  };
  // Looks for a command that starts at cycle `slot`. True if the search can end: a command was found, or `best` starts
  // earlier.
  const auto is_over = [&](Cycle slot) {
    if (none_is_better(slot)) return true;
    const std::uint32_t ready = bank_mask & device_.ready_bank_mask<kCommand>(writes, slot);
    if (ready != 0)
      take(slot, kCommand == DramCommand::kColumn ? queue.hit_position_mask_of_banks(ready)
                                                  : queue.request_position_mask_of_banks(ready));
    return ready != 0;
  };
  if (is_over(device_.first_bus_slot(kCommand, rank, rank_ready))) return;
  is_over(device_.first_bus_slot(kCommand, rank, device_.first_ready_cycle<kCommand>(bank_mask, writes)));
}

ScheduledCommand DramScheduler::best_command(const DramQueue& queue, bool writes, bool is_overdue, Cycle now) const {
  const EligibleBanks eligible = policy_ == DramSchedulingPolicy::kFcfs ? Fcfs::eligible_banks(queue, is_overdue)
                                                                        : FrFcfs::eligible_banks(queue, is_overdue);
  const Cycle from = device_.first_awake_cycle(now);
  ScheduledCommand best;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    const std::uint32_t here = eligible.all & device_.bank_mask_of_rank(rank), others = here & ~eligible.columns;
    keep_better_command<DramCommand::kColumn>(queue, here & eligible.columns, rank, writes, from, best);
    keep_better_command<DramCommand::kActivate>(queue, others & ~device_.open_bank_mask(), rank, writes, from, best);
    keep_better_command<DramCommand::kPrecharge>(queue, others & device_.open_bank_mask(), rank, writes, from, best);
  }
  return best;
}

static std::size_t max_booked_bursts(const DramTiming& timing) {
  return (std::max(timing.rl + timing.dqsck, timing.wl + timing.dqss) + 64) / timing.burst + 4;
}

DramChannel::DramChannel(const DramConfig& c, Links links, bool ideal, const DramPerturbation& perturbation)
    : controller_(c.controller),
      map_(c),
      ranks_(c.organisation.ranks),
      ideal_(ideal),
      bursts_(c.bursts_per_line()),
      line_bytes_(c.line.bytes),
      fabric_(perturbation.perturbed_fabric_cycles((c.fabric.time + c.timing.ck.time - 1) / c.timing.ck.time)),
      refresh_interval_(c.refresh_interval()),
      refresh_cycles_(c.controller.refresh == RefreshKind::kAllBank ? c.timing.rfc_ab : c.timing.rfc_pb),
      exit_cycles_(c.timing.xp),
      clock_(c.timing.ck.time),
      ports_in_(std::move(links.ports_in)),
      ports_out_(std::move(links.ports_out)),
      observer_(links.observer),
      device_(c),
      scheduler_(c, device_),
      data_bus_(max_booked_bursts(c.timing)),
      page_policy_(c.controller.page_policy),
      refresh_at_(refresh_interval_ == 0 || ideal ? sim::kNever : perturbation.first_refresh_cycle(refresh_interval_)),
      unrefreshed_banks_(device_.refresh_command_bank_mask()),
      reads_(c.controller.read_queue, c.organisation.all_banks()),
      writes_(c.controller.write_queue, c.organisation.all_banks()),
      ports_(Arbitration::kRoundRobin, ports_in_.size()) {
  const Cycle in_flight = fabric_ + c.timing.rl + c.timing.dqsck + device_.line_transfer_cycles();
  max_returns_ = 2 * (in_flight / (Cycle{bursts_} * c.timing.burst) + 4);
}

sim::Time DramChannel::tick(sim::Time now) {
  if (ideal_) return tick_ideal(now);
  const Cycle cycle = clock_.cycles(now);
  account_until(cycle);
  if (refresh_at_ <= cycle) run_due_refreshes(cycle);
  if (ports_in_.pop_at() <= now) take_request(now, cycle);
  if (!returns_.empty() && send_response(returns_.front(), now)) {
    next_is_stale_ |= returns_.size() == max_returns_;
    returns_.pop_front();
  }
  if (next_is_stale_ || cycle >= reschedule_at_) choose_next_command(cycle);
  if (next_.start_cycle() <= cycle) {
    assert(next_ == best_command(cycle) && "a command that survives is the one chosen afresh");
    issue_command(now, cycle);
    choose_next_command(cycle);
  }
  return next_wake(now);
}

void DramChannel::finish(sim::Time end) {
  const Cycle cycle = clock_.cycles(end);
  if (!ideal_) {
    account_until(cycle);
    run_due_refreshes(cycle);
    power_down_if_idle(cycle);
    count_power_down_cycles(cycle);
  }
  activity_.finish(end);
  stats_.turnarounds = device_.turnaround_count();
  stats_.active_standby = device_.cycles_with_open_row(cycle);
  stats_.precharge_standby = ranks_ * cycle - stats_.active_standby - stats_.power_down;
}

inline void DramChannel::take_request(sim::Time now, Cycle cycle) {
  const auto has_room = [&](std::uint32_t i) {
    return ports_in_.can_pop(i, now) && has_room_for(ports_in_[i].front());
  };
  const std::uint32_t port =
      ports_.choose_requester(ports_in_.nonempty_mask(), has_room, [](std::uint32_t) { return sim::Time{0}; });
  if (port == ports_.requester_count()) return;
  ports_.note_served(port);
  const MemRequest request = ports_in_[port].pop(now);
  const DramAddress address = map_.address_of(request.line);
  if (controller_.power_down) {
    power_down_if_idle(cycle);
    leave_power_down(cycle);
  }
  page_policy_.note_request(address.bank, address.row);
  const bool row_is_open = device_.is_open(address.bank, address.row);
  next_is_stale_ |= !next_command_survives(request.write, address.bank, row_is_open);
  (request.write ? writes_ : reads_).push({request, address, cycle, static_cast<std::uint16_t>(port)}, row_is_open);
}

/// True if a new request cannot change which command the DRAM channel issues next. Under load this is the usual case,
/// because older requests of the same bank have priority.
inline bool DramChannel::next_command_survives(bool write, std::uint32_t bank, bool row_is_open) const {
  if (write != writing_) return false;
  const DramQueue& queue = write ? writes_ : reads_;
  return queue.hit_position_mask(bank) != 0 || (queue.request_position_mask(bank) != 0 && !row_is_open);
}

/// Sends the line of a read to its requester, at most one line per cycle. If the link will have room when the line is
/// due, pushes the line now, with the due time as its timestamp. Its entry in the return queue is then freed early.
/// That has no effect, because the queue has room for twice the lines that can be pending.
bool DramChannel::send_response(const Return& line, sim::Time now) {
  const sim::Time at = std::max(now, line.due);
  sim::Link<MemResponse>& out = *ports_out_[line.port];
  if (at < return_at_ || !out.can_push(at)) return false;
  out.push(at, line.response);
  return_at_ = at + clock_.period();
  return true;
}

inline sim::Time DramChannel::next_wake(sim::Time now) const {
  // While the channel has no scheduled command, it need not wake for refreshes. Its next tick performs them.
  const Cycle cycle = std::min({next_.start_cycle(), reschedule_at_, next_.is_none() ? sim::kNever : refresh_at_});
  sim::Time wake = cycle == sim::kNever ? sim::kNever : cycle * clock_.period();
  if (!returns_.empty())
    wake = std::min(wake, std::max(returns_.front().due, ports_out_[returns_.front().port]->push_at()));
  for (std::uint64_t left = ports_in_.nonempty_mask(); left != 0; left &= left - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(left));
    const sim::Time at = ports_in_.pop_at(i);
    if (at > now || has_room_for(ports_in_[i].front())) wake = std::min(wake, at);
  }
  return std::max(wake, now + clock_.period());
}

void DramChannel::choose_next_command(Cycle now) {
  next_is_stale_ = false;
  const Cycle read_due = overdue_cycle(reads_), write_due = overdue_cycle(writes_);
  reschedule_at_ = std::min(read_due <= now ? sim::kNever : read_due, write_due <= now ? sim::kNever : write_due);
  if (writes_.size() >= controller_.write_high) draining_ = true;
  if (writes_.size() <= controller_.write_low) draining_ = false;
  writing_ = serves_writes_first(read_due, write_due, now);
  const DramQueue& queue = writing_ ? writes_ : reads_;
  const bool blocked = !writing_ && returns_.size() == max_returns_;
  next_ = queue.empty() || blocked ? ScheduledCommand{} : best_command(now);
}

ScheduledCommand DramChannel::best_command(Cycle now) const {
  const DramQueue& queue = writing_ ? writes_ : reads_;
  return scheduler_.best_command(queue, writing_, overdue_cycle(queue) <= now, now);
}

/// Returns the reason for idle cycles of the DRAM data bus, valid until the channel next chooses a command.
DramChannel::CycleReason DramChannel::wait_reason() const {
  if ((writing_ ? writes_ : reads_).empty()) return CycleReason::kIdle;
  if (next_.is_none()) return CycleReason::kReturnsFull;
  return device_.wait_reason(next_.command_kind(), next_.bank(), writing_, next_.start_cycle());
}

/// True if the DRAM channel serves its write queue before its read queue. `read_due` and `write_due`: cycles at which
/// the oldest read and the oldest write exceed the age limit.
inline bool DramChannel::serves_writes_first(Cycle read_due, Cycle write_due, Cycle now) const {
  if (reads_.empty() || writes_.empty()) return reads_.empty();
  if (read_due <= now && write_due <= now) return write_due < read_due;
  return read_due <= now || write_due <= now ? write_due <= now : draining_;
}

inline void DramChannel::issue_command(sim::Time now, Cycle cycle) {
  DramQueue& queue = writing_ ? writes_ : reads_;
  DramQueue::Entry& entry = queue.at(next_.queue_position());
  const DramAddress address = entry.address;
  switch (next_.command_kind()) {
    case DramCommand::kColumn:
      transfer_line(entry, now, cycle);
      queue.remove_at(next_.queue_position());
      if ((reads_.hit_position_mask(address.bank) | writes_.hit_position_mask(address.bank)) == 0)
        apply_page_policy(address);
      break;
    case DramCommand::kActivate:
      entry.activated = true;
      stats_.activates += 1;
      if (observer_ != nullptr) [[unlikely]]
        notify(*observer_, RowActivated{entry.request.tile});
      device_.activate_row(address.bank, address.row, cycle);
      reads_.note_row_opened(address.bank, address.row);
      writes_.note_row_opened(address.bank, address.row);
      break;
    case DramCommand::kPrecharge:
      entry.precharged = true;
      device_.precharge_bank(address.bank, cycle);
      reads_.note_row_closed(address.bank);
      writes_.note_row_closed(address.bank);
      break;
  }
}

/// Closes a DRAM row after its last queued hit, if the page policy requires it.
inline void DramChannel::apply_page_policy(const DramAddress& address) {
  const bool others = (reads_.request_position_mask(address.bank) | writes_.request_position_mask(address.bank)) != 0;
  if (page_policy_.should_close_row(address.bank, address.row, others)) device_.auto_precharge(address.bank);
}

/// Books the DRAM data bus for the line of a read or write, and counts the transfer.
inline void DramChannel::transfer_line(const DramQueue::Entry& entry, sim::Time now, Cycle cycle) {
  const MemRequest& r = entry.request;
  const Cycle data =
      r.write ? device_.write_line(entry.address.bank, cycle) : device_.read_line(entry.address.bank, cycle);
  const Cycle end = data + device_.line_transfer_cycles();
  data_end_ = std::max(data_end_, end);
  device_.for_each_burst(data, [&](Cycle begin, Cycle burst_end) {
    data_bus_.book_burst({begin, burst_end, r.write});
  });
  if (r.write) {
    stats_.writes += 1;
    stats_.write_bursts += bursts_;
  } else {
    const Return line{{r.line, r.source, r.tag}, entry.port, (end + fabric_) * clock_.period()};
    if (!returns_.empty() || !send_response(line, now)) returns_.push_back(line);
    stats_.reads += 1;
    stats_.read_bursts += bursts_;
    stats_.read_latency += end - entry.arrived;
    stats_.read_latency_max = std::max(stats_.read_latency_max, end - entry.arrived);
  }
  stats_.bytes += line_bytes_;
  (entry.precharged ? stats_.row_conflicts : entry.activated ? stats_.row_misses : stats_.row_hits) += 1;
  if (observer_ != nullptr) [[unlikely]] {
    const RowState row = entry.precharged ? RowState::kConflict : entry.activated ? RowState::kMiss : RowState::kHit;
    notify(*observer_, DramServed{r, row, end * clock_.period()});
  }
}

/// Charges each cycle before `until` to a reason: reading or writing while the DRAM data bus is busy, otherwise the
/// reason for which the next command waits.
void DramChannel::account_until(Cycle until) {
  while (accounted_until_ < until) {
    Cycle end = until;
    CycleReason why;
    if (!data_bus_.empty() && data_bus_.front().begin <= accounted_until_) {
      const DataBus::Burst& burst = data_bus_.front();
      end = std::min(until, burst.end);
      why = burst.write ? CycleReason::kWriting : CycleReason::kReading;
      if (end == burst.end) data_bus_.pop();
    } else {
      why = wait_reason();
      if (!data_bus_.empty()) {
        end = std::min(until, data_bus_.front().begin);
        if (why == CycleReason::kIdle) why = CycleReason::kLatency;
      }
    }
    activity_.spend(accounted_until_ * clock_.period(), clock_.period(), why, why);
    accounted_until_ = end;
  }
}

std::string DramChannel::state() const {
  return fmt::format("{} reads and {} writes queued, {} lines to return, {} banks open, {}", reads_.size(),
                     writes_.size(), returns_.size(), device_.open_bank_count(), writing_ ? "writing" : "reading");
}

/// Performs every refresh of the DRAM channel that is due by `now`, each at the cycle at which it was due. The result
/// does not depend on the time of the call.
void DramChannel::run_due_refreshes(Cycle now) {
  const auto due_after = [&](std::uint64_t turns) {
    return refresh_interval_ * (turns / ranks_ + 1) + refresh_interval_ * (turns % ranks_) / ranks_;
  };
  while (refresh_at_ <= now) {
    Cycle due = refresh_at_;
    power_down_if_idle(due);
    if (is_down_) {
      if (due > down_since_) {
        count_power_down_cycles(due);
        due += exit_cycles_;
        device_.leave_power_down(due);
      }
      down_since_ = std::max(due, down_since_) + refresh_cycles_;
    }
    refresh_banks(static_cast<std::uint32_t>(refresh_turn_ % ranks_), due);
    refresh_at_ += due_after(refresh_turn_ + 1) - due_after(refresh_turn_);
    refresh_turn_ += 1;
    next_is_stale_ = true;
  }
}

void DramChannel::refresh_banks(std::uint32_t rank, Cycle due) {
  if (controller_.refresh == RefreshKind::kAllBank) {
    device_.refresh_rank(rank, due);
    note_rows_closed(device_.bank_mask_of_rank(rank));
    stats_.refreshes_all += 1;
    return;
  }
  const std::uint32_t leader = next_bank_to_refresh(rank);
  const std::uint32_t banks = device_.refresh_bank_mask_of(leader);
  device_.refresh_banks(banks, due);
  note_rows_closed(banks);
  stats_.refreshes += 1;
  unrefreshed_banks_ &= ~(1U << leader);
  const std::uint32_t of_rank = device_.bank_mask_of_rank(rank);
  if ((unrefreshed_banks_ & of_rank) == 0) unrefreshed_banks_ |= device_.refresh_command_bank_mask() & of_rank;
}

std::uint32_t DramChannel::next_bank_to_refresh(std::uint32_t rank) const {
  const std::uint32_t candidates = unrefreshed_banks_ & device_.bank_mask_of_rank(rank);
  if (controller_.refresh_order == RefreshOrder::kIdleFirst) {
    const std::uint32_t wanted = reads_.requested_bank_mask() | writes_.requested_bank_mask();
    for (std::uint32_t left = candidates; left != 0; left &= left - 1) {
      const auto leader = static_cast<std::uint32_t>(std::countr_zero(left));
      if ((wanted & device_.refresh_bank_mask_of(leader)) == 0) return leader;
    }
  }
  return static_cast<std::uint32_t>(std::countr_zero(candidates));
}

/// Updates the row hits of both request queues after the DRAM device has closed the banks in the mask `bank_mask`.
void DramChannel::note_rows_closed(std::uint32_t bank_mask) {
  for (std::uint32_t left = bank_mask; left != 0; left &= left - 1) {
    const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
    reads_.note_row_closed(bank);
    writes_.note_row_closed(bank);
  }
}

/// Puts the DRAM channel into power-down if it has been idle long enough before `now`. Must be called before any change
/// of the channel's state. The time of the call does not affect the result.
void DramChannel::power_down_if_idle(Cycle now) {
  const Cycle due = data_end_ + controller_.power_down_after;
  if (!controller_.power_down || is_down_ || due >= now || !reads_.empty() || !writes_.empty()) return;
  is_down_ = true;
  down_since_ = due;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank)
    down_since_ = std::max(down_since_, device_.precharge_banks(device_.bank_mask_of_rank(rank), due));
}

void DramChannel::count_power_down_cycles(Cycle until) {
  const Cycle from = std::max(down_since_, down_counted_);
  if (!is_down_ || until <= from) return;
  stats_.power_down += ranks_ * (until - from);
  down_counted_ = until;
}

/// Takes the DRAM channel out of power-down because a request has arrived.
void DramChannel::leave_power_down(Cycle now) {
  if (!is_down_) return;
  count_power_down_cycles(now);
  is_down_ = false;
  if (now <= down_since_) return;
  stats_.power_downs += 1;
  device_.leave_power_down(now + exit_cycles_);
}

/// Ticks an ideal DRAM channel, which answers every request in the cycle in which it arrives.
sim::Time DramChannel::tick_ideal(sim::Time now) {
  CycleReason why = CycleReason::kIdle;
  bool blocked = false;
  sim::Time wake = sim::kNever;
  for (std::size_t port = 0; port < ports_in_.size(); ++port) {
    sim::Link<MemRequest>& in = ports_in_[port];
    sim::Link<MemResponse>& out = *ports_out_[port];
    while (in.can_pop(now) && (in.front().write || out.can_push(now))) {
      const MemRequest r = in.pop(now);
      (r.write ? stats_.writes : stats_.reads) += 1;
      (r.write ? stats_.write_bursts : stats_.read_bursts) += bursts_;
      stats_.bytes += line_bytes_;
      stats_.row_hits += 1;
      why = r.write ? CycleReason::kWriting : CycleReason::kReading;
      if (!r.write) out.push(now, {r.line, r.source, r.tag});
      if (observer_ != nullptr) notify(*observer_, DramServed{r, RowState::kHit, now + clock_.period()});
    }
    const bool stuck = in.can_pop(now);
    blocked |= stuck;
    if (stuck) wake = std::min(wake, std::max(now + clock_.period(), out.push_at()));
    if (!stuck && in.pop_at() != sim::kNever) wake = std::min(wake, in.pop_at());
  }
  const CycleReason then = blocked ? CycleReason::kReturnsFull : CycleReason::kIdle;
  activity_.spend(now, clock_.period(), why == CycleReason::kIdle ? then : why, then);
  return wake;
}

}  // namespace hw
