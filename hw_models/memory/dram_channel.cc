#include "hw_models/memory/dram_channel.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

namespace hw {

namespace {

std::size_t most_bursts(const DramTiming& t) { return (std::max(t.rl + t.dqsck, t.wl + t.dqss) + 64) / t.burst + 4; }

}  // namespace

DramChannel::DramChannel(const DramConfig& c, Links links, bool ideal)
    : controller_(c.controller),
      map_(c),
      ranks_(c.organisation.ranks),
      ideal_(ideal),
      bursts_(c.bursts_per_line()),
      line_bytes_(c.line.bytes),
      fabric_((c.fabric.time + c.timing.ck.time - 1) / c.timing.ck.time),
      refresh_interval_(c.refresh_interval()),
      refresh_cycles_(c.controller.refresh == RefreshKind::kAllBank ? c.timing.rfc_ab : c.timing.rfc_pb),
      exit_cycles_(c.timing.xp),
      clock_(c.timing.ck.time),
      ports_in_(std::move(links.ports_in)),
      ports_out_(std::move(links.ports_out)),
      watcher_(links.watcher),
      device_(c),
      data_bus_(most_bursts(c.timing)),
      page_policy_(c.controller.page_policy),
      refresh_at_(refresh_interval_ == 0 || ideal ? sim::kNever : refresh_interval_),
      to_refresh_(device_.refresh_leaders()),
      reads_(c.controller.read_queue),
      writes_(c.controller.write_queue),
      ports_(Arbitration::kRoundRobin, ports_in_.size()) {
  assert(ports_in_.size() == ports_out_.size());
  // Room for what a full data bus brings in while the device and the fabric delay it, and as much again.
  const Cycle in_flight = fabric_ + c.timing.rl + c.timing.dqsck + device_.data_cycles();
  returns_.slots.resize(2 * (in_flight / (Cycle{bursts_} * c.timing.burst) + 4));
}

sim::Time DramChannel::tick(sim::Time now) {
  if (ideal_) return tick_ideal(now);
  const Cycle cycle = clock_.cycles(now);
  settle(cycle);
  if (refresh_at_ <= cycle) refresh(cycle);
  if (ports_in_.holding() != 0) take_request(now, cycle);
  if (returns_.size != 0) respond(now, cycle);
  if (plan_is_stale_ || cycle >= replan_at_) replan(cycle);
  if (plan_.at() <= cycle) {
    assert(plan_ == best_plan(writing_ ? writes_ : reads_, cycle) && "a plan that survives is the plan made afresh");
    issue(cycle);
    replan(cycle);
  }
  return next_wake(now);
}

void DramChannel::finish(sim::Time end) {
  const Cycle cycle = clock_.cycles(end);
  if (!ideal_) {
    settle(cycle);
    refresh(cycle);
    power_down(cycle);
    if (is_down_ && cycle > down_since_) {
      stats_.power_down += ranks_ * (cycle - down_since_);
      down_since_ = cycle;
    }
  }
  activity_.finish(end);
  stats_.turnarounds = device_.turnarounds();
  stats_.active_standby = device_.active_cycles(cycle);
  stats_.precharge_standby = ranks_ * cycle - stats_.active_standby - stats_.power_down;
}

void DramChannel::take_request(sim::Time now, Cycle cycle) {
  const auto has_room = [&](std::uint32_t i) {
    return ports_in_[i].can_pop(now) && !(ports_in_[i].front().write ? writes_ : reads_).full();
  };
  const std::uint32_t port = ports_.choose(ports_in_.holding(), has_room, [](std::uint32_t) { return sim::Time{0}; });
  if (port == ports_.count()) return;
  ports_.served(port);
  const MemRequest request = ports_in_[port].pop(now);
  const DramPlace place = map_.place(request.line);
  power_down(cycle);
  wake(cycle);
  page_policy_.requested(place.bank, place.row);
  const bool row_is_open = device_.is_open(place.bank, place.row);
  plan_is_stale_ |= !plan_survives(request.write, place.bank, row_is_open);
  (request.write ? writes_ : reads_).push({request, place, cycle, static_cast<std::uint16_t>(port)}, row_is_open);
}

/// Does a new request leave its bank's next command as it is? The common case under load: older requests of its bank
/// come first anyway.
bool DramChannel::plan_survives(bool write, std::uint32_t bank, bool row_is_open) const {
  if (write != writing_) return false;
  const DramQueue& queue = write ? writes_ : reads_;
  return queue.hits(bank) != 0 || (queue.waiting(bank) != 0 && !row_is_open);
}

void DramChannel::respond(sim::Time now, Cycle cycle) {
  const Return& first = returns_.slots[returns_.head];
  sim::Link<MemResponse>& out = *ports_out_[first.port];
  if (first.due > cycle || !out.can_push(now)) return;
  out.push(now, first.response);
  plan_is_stale_ |= returns_.full();
  returns_.head = (returns_.head + 1) % returns_.slots.size();
  returns_.size -= 1;
}

sim::Time DramChannel::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  const auto time_of = [&](Cycle cycle) { return cycle == sim::kNever ? sim::kNever : cycle * clock_.period(); };
  sim::Time wake = std::min(time_of(plan_.at()), time_of(replan_at_));
  // While no command can come, refreshes are caught up with later: they change nothing that anyone could see.
  if (!plan_.none()) wake = std::min(wake, time_of(refresh_at_));
  if (returns_.size > 0) {
    const Return& first = returns_.slots[returns_.head];
    wake = std::min(wake, std::max({next, time_of(first.due), ports_out_[first.port]->push_at()}));
  }
  ports_in_.each([&](const sim::Link<MemRequest>& in) {
    const sim::Time at = in.pop_at();
    const bool room = at > now || !(in.front().write ? writes_ : reads_).full();
    if (room) wake = std::min(wake, std::max(next, at));
  });
  return wake;
}

void DramChannel::replan(Cycle now) {
  plan_is_stale_ = false;
  replan_at_ = sim::kNever;
  for (const DramQueue* queue : {&reads_, &writes_}) {
    if (!queue->empty() && !overdue(*queue, now))
      replan_at_ = std::min(replan_at_, queue->oldest().arrived + controller_.age_limit);
  }
  writing_ = writes_first(now);
  const DramQueue& queue = writing_ ? writes_ : reads_;
  const bool blocked = !writing_ && returns_.full();
  plan_ = queue.empty() || blocked ? ScheduledCommand{} : best_plan(queue, now);
  waiting_ = queue.empty() ? CycleReason::kIdle
             : blocked     ? CycleReason::kReturnsFull
                           : device_.reason(plan_.command(), plan_.bank(), writing_, plan_.at());
}

bool DramChannel::writes_first(Cycle now) {
  if (writes_.size() >= controller_.write_high) draining_ = true;
  if (writes_.size() <= controller_.write_low) draining_ = false;
  if (reads_.empty() || writes_.empty()) return reads_.empty();
  const bool old_read = overdue(reads_, now);
  const bool old_write = overdue(writes_, now);
  if (old_read && old_write) return writes_.oldest().arrived < reads_.oldest().arrived;
  return old_read == old_write ? draining_ : old_write;
}

DramChannel::ScheduledCommand DramChannel::best_plan(const DramQueue& queue, Cycle now) const {
  const bool in_turn = controller_.scheduler == DramScheduler::kFcfs;
  std::uint32_t banks = queue.banks(), columns = queue.hit_banks();
  if (in_turn || overdue(queue, now)) {
    const std::uint32_t first = 1U << queue.oldest().place.bank;
    if ((queue.hits(queue.oldest().place.bank) & 1) == 0) columns &= ~first;
    if (in_turn) banks = first;
  }
  const std::uint32_t open = device_.open_mask();
  ScheduledCommand best;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    const DramDevice::Floors rank_ready = device_.rank_ready(rank, writing_, now);
    const std::uint32_t here = banks & device_.banks_of(rank);
    const auto consider = [&]<DramCommand command>(std::uint32_t of) {
      if (best < ScheduledCommand(rank_ready[static_cast<std::size_t>(command)], command, 0, 0))
        return;  // none can come before it
      for (std::uint32_t left = of; left != 0; left &= left - 1) {
        const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
        const Cycle ready = device_.ready(command, bank, writing_, rank_ready);
        if (best < ScheduledCommand(ready, command, 0, 0)) continue;
        const std::uint64_t places = command == DramCommand::kColumn ? queue.hits(bank) : queue.waiting(bank);
        const auto place = static_cast<std::uint32_t>(std::countr_zero(places));
        best = std::min(best, ScheduledCommand(device_.earliest(command, ready), command, place, bank));
      }
    };
    consider.template operator()<DramCommand::kColumn>(here & columns);
    consider.template operator()<DramCommand::kActivate>(here & ~columns & ~open);
    consider.template operator()<DramCommand::kPrecharge>(here & ~columns & open);
  }
  return best;
}

void DramChannel::issue(Cycle now) {
  DramQueue& queue = writing_ ? writes_ : reads_;
  DramQueue::Entry& entry = queue.at(plan_.place());
  const DramPlace place = entry.place;
  switch (plan_.command()) {
    case DramCommand::kColumn:
      transfer(entry, now);
      queue.remove(plan_.place());
      if ((reads_.hits(place.bank) | writes_.hits(place.bank)) == 0) row_done(place);
      break;
    case DramCommand::kActivate:
      entry.activated = true;
      stats_.activates += 1;
      device_.activate(place.bank, place.row, now);
      reads_.row_opened(place.bank, place.row);
      writes_.row_opened(place.bank, place.row);
      break;
    case DramCommand::kPrecharge:
      entry.precharged = true;
      device_.precharge(place.bank, now);
      reads_.row_closed(place.bank);
      writes_.row_closed(place.bank);
      break;
  }
}

/// The last queued hit of the row is on its way.
void DramChannel::row_done(const DramPlace& place) {
  const bool others = (reads_.waiting(place.bank) | writes_.waiting(place.bank)) != 0;
  if (page_policy_.closes(place.bank, place.row, others)) device_.auto_precharge(place.bank);
}

/// Moves the request's line over the data bus.
void DramChannel::transfer(const DramQueue::Entry& entry, Cycle now) {
  const MemRequest& r = entry.request;
  const Cycle data = r.write ? device_.write(entry.place.bank, now) : device_.read(entry.place.bank, now);
  const Cycle end = data + device_.data_cycles();
  data_end_ = std::max(data_end_, end);
  if (watcher_ != nullptr) watcher_->served(r, end * clock_.period());
  device_.each_burst(data, [&](Cycle begin, Cycle burst_end) { data_bus_.book({begin, burst_end, r.write}); });
  if (r.write) {
    stats_.writes += 1;
    stats_.write_bursts += bursts_;
  } else {
    returns_.slots[(returns_.head + returns_.size) % returns_.slots.size()] = {
        {r.line, r.source, r.tag}, entry.port, end + fabric_};
    returns_.size += 1;
    stats_.reads += 1;
    stats_.read_bursts += bursts_;
    stats_.read_latency += end - entry.arrived;
    stats_.read_latency_max = std::max(stats_.read_latency_max, end - entry.arrived);
  }
  stats_.bytes += line_bytes_;
  (entry.precharged ? stats_.row_conflicts : entry.activated ? stats_.row_misses : stats_.row_hits) += 1;
}

/// Runs every refresh due by now, each at its own time: the outcome is the same whenever this is called.
void DramChannel::refresh(Cycle now) {
  while (refresh_at_ <= now) {
    Cycle due = refresh_at_;
    power_down(due);
    if (is_down_) {
      if (due > down_since_) {
        stats_.power_down += ranks_ * (due - down_since_);
        due += exit_cycles_;
        device_.wake(due);
      }
      down_since_ = std::max(due, down_since_) + refresh_cycles_;
    }
    refresh_banks(static_cast<std::uint32_t>(refresh_turn_ % ranks_), due);
    refresh_turn_ += 1;
    refresh_at_ =
        refresh_interval_ * (refresh_turn_ / ranks_ + 1) + refresh_interval_ * (refresh_turn_ % ranks_) / ranks_;
    plan_is_stale_ = true;
  }
}

void DramChannel::refresh_banks(std::uint32_t rank, Cycle due) {
  if (controller_.refresh == RefreshKind::kAllBank) {
    device_.refresh_rank(rank, due);
    close_rows(device_.banks_of(rank));
    stats_.refreshes_all += 1;
    return;
  }
  const std::uint32_t leader = next_refresh(rank);
  const std::uint32_t banks = device_.refreshed_with(leader);
  device_.refresh(banks, due);
  close_rows(banks);
  stats_.refreshes += 1;
  to_refresh_ &= ~(1U << leader);
  const std::uint32_t of_rank = device_.banks_of(rank);
  if ((to_refresh_ & of_rank) == 0) to_refresh_ |= device_.refresh_leaders() & of_rank;
}

std::uint32_t DramChannel::next_refresh(std::uint32_t rank) const {
  const std::uint32_t candidates = to_refresh_ & device_.banks_of(rank);
  if (controller_.refresh_order == RefreshOrder::kIdleFirst) {
    const std::uint32_t wanted = reads_.banks() | writes_.banks();
    for (std::uint32_t left = candidates; left != 0; left &= left - 1) {
      const auto leader = static_cast<std::uint32_t>(std::countr_zero(left));
      if ((wanted & device_.refreshed_with(leader)) == 0) return leader;
    }
  }
  return static_cast<std::uint32_t>(std::countr_zero(candidates));
}

/// The device has closed these banks.
void DramChannel::close_rows(std::uint32_t banks) {
  for (std::uint32_t left = banks; left != 0; left &= left - 1) {
    const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
    reads_.row_closed(bank);
    writes_.row_closed(bank);
  }
}

/// Powers down if the channel has been idle for long enough before `now`: as with refreshes, it does not matter when
/// this is called, as long as it is before something changes.
void DramChannel::power_down(Cycle now) {
  const Cycle due = data_end_ + controller_.power_down_after;
  if (!controller_.power_down || is_down_ || due >= now || !reads_.empty() || !writes_.empty()) return;
  is_down_ = true;
  down_since_ = due;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank)
    down_since_ = std::max(down_since_, device_.precharge_all(device_.banks_of(rank), due));
}

/// A request has arrived.
void DramChannel::wake(Cycle now) {
  if (!is_down_) return;
  is_down_ = false;
  if (now <= down_since_) return;
  stats_.power_down += ranks_ * (now - down_since_);
  stats_.power_downs += 1;
  device_.wake(now + exit_cycles_);
}

/// Charges the cycles before `until`: to the data bus while it moves data, else to what the next command waits for.
void DramChannel::settle(Cycle until) {
  while (settled_ < until) {
    Cycle end = until;
    CycleReason why = waiting_;
    if (!data_bus_.empty()) {
      const DataBus::Burst burst = data_bus_.front();
      if (burst.begin > settled_) {
        end = std::min(until, burst.begin);
        if (why == CycleReason::kIdle) why = CycleReason::kLatency;
      } else {
        end = std::min(until, burst.end);
        why = burst.write ? CycleReason::kWriting : CycleReason::kReading;
        if (end == burst.end) data_bus_.pop();
      }
    }
    activity_.spend(settled_ * clock_.period(), clock_.period(), why, why);
    settled_ = end;
  }
}

sim::Time DramChannel::tick_ideal(sim::Time now) {
  CycleReason why = CycleReason::kIdle;
  bool blocked = false;
  sim::Time wake = sim::kNever;
  for (std::size_t port = 0; port < ports_in_.size(); ++port) {
    sim::Link<MemRequest>& in = ports_in_[port];
    sim::Link<MemResponse>& out = *ports_out_[port];
    const auto open = [&] { return in.front().write || out.can_push(now); };
    while (in.can_pop(now) && open()) {
      const MemRequest r = in.pop(now);
      (r.write ? stats_.writes : stats_.reads) += 1;
      (r.write ? stats_.write_bursts : stats_.read_bursts) += bursts_;
      stats_.bytes += line_bytes_;
      stats_.row_hits += 1;
      why = r.write ? CycleReason::kWriting : CycleReason::kReading;
      if (!r.write) out.push(now, {r.line, r.source, r.tag});
      if (watcher_ != nullptr) watcher_->served(r, now + clock_.period());
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

std::string DramChannel::state() const {
  return fmt::format("{} reads and {} writes queued, {} lines to return, {} banks open, {}", reads_.size(),
                     writes_.size(), returns_.size, device_.open_banks(), writing_ ? "writing" : "reading");
}

}  // namespace hw
