#include "hw_models/dram/dram_channel.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

namespace hw {

static std::size_t most_bursts(const DramTiming& t) {
  return (std::max(t.rl + t.dqsck, t.wl + t.dqss) + 64) / t.burst + 4;
}

DramChannel::DramChannel(const DramConfig& c, Links links, bool ideal, const DramShift& shift)
    : controller_(c.controller),
      map_(c),
      ranks_(c.organisation.ranks),
      ideal_(ideal),
      is_watched_(links.watcher != nullptr || links.book != nullptr),
      bursts_(c.bursts_per_line()),
      line_bytes_(c.line.bytes),
      fabric_(shift.moved_fabric((c.fabric.time + c.timing.ck.time - 1) / c.timing.ck.time)),
      refresh_interval_(c.refresh_interval()),
      refresh_cycles_(c.controller.refresh == RefreshKind::kAllBank ? c.timing.rfc_ab : c.timing.rfc_pb),
      exit_cycles_(c.timing.xp),
      clock_(c.timing.ck.time),
      ports_in_(std::move(links.ports_in)),
      ports_out_(std::move(links.ports_out)),
      watcher_(links.watcher),
      book_(links.book),
      device_(c),
      data_bus_(most_bursts(c.timing)),
      page_policy_(c.controller.page_policy),
      refresh_at_(refresh_interval_ == 0 || ideal ? sim::kNever : shift.first_refresh(refresh_interval_)),
      to_refresh_(device_.refresh_leaders()),
      reads_(c.controller.read_queue),
      writes_(c.controller.write_queue),
      ports_(Arbitration::kRoundRobin, ports_in_.size()) {
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
  if (next_is_stale_ || cycle >= reschedule_at_) reschedule(cycle);
  if (next_.at() <= cycle) {
    assert(next_ == best_command(writing_ ? writes_ : reads_, cycle) &&
           "a command that survives is the one chosen afresh");
    issue(cycle);
    reschedule(cycle);
  }
  return next_wake(now);
}

void DramChannel::finish(sim::Time end) {
  const Cycle cycle = clock_.cycles(end);
  if (!ideal_) {
    settle(cycle);
    refresh(cycle);
    power_down(cycle);
    count_power_down(cycle);
  }
  activity_.finish(end);
  stats_.turnarounds = device_.turnarounds();
  stats_.active_standby = device_.active_cycles(cycle);
  stats_.precharge_standby = ranks_ * cycle - stats_.active_standby - stats_.power_down;
}

inline void DramChannel::take_request(sim::Time now, Cycle cycle) {
  const auto has_room = [&](std::uint32_t i) {
    return ports_in_.can_pop(i, now) && !(ports_in_[i].front().write ? writes_ : reads_).full();
  };
  const std::uint32_t port = ports_.choose(ports_in_.holding(), has_room, [](std::uint32_t) { return sim::Time{0}; });
  if (port == ports_.count()) return;
  ports_.served(port);
  const MemRequest request = ports_in_[port].pop(now);
  const DramAddress address = map_.address(request.line);
  power_down(cycle);
  wake(cycle);
  page_policy_.requested(address.bank, address.row);
  const bool row_is_open = device_.is_open(address.bank, address.row);
  next_is_stale_ |= !next_survives(request.write, address.bank, row_is_open);
  (request.write ? writes_ : reads_).push({request, address, cycle, static_cast<std::uint16_t>(port)}, row_is_open);
}

/// Does a new request leave its bank's next command as it is? The common case under load: older requests of its bank
/// come first anyway.
inline bool DramChannel::next_survives(bool write, std::uint32_t bank, bool row_is_open) const {
  if (write != writing_) return false;
  const DramQueue& queue = write ? writes_ : reads_;
  return queue.hits(bank) != 0 || (queue.waiting(bank) != 0 && !row_is_open);
}

inline void DramChannel::respond(sim::Time now, Cycle cycle) {
  const Return& first = returns_.slots[returns_.head];
  sim::Link<MemResponse>& out = *ports_out_[first.port];
  if (first.due > cycle || !out.can_push(now)) return;
  out.push(now, first.response);
  next_is_stale_ |= returns_.full();
  returns_.head = (returns_.head + 1) % returns_.slots.size();
  returns_.size -= 1;
}

inline sim::Time DramChannel::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  const auto time_of = [&](Cycle cycle) { return cycle == sim::kNever ? sim::kNever : cycle * clock_.period(); };
  sim::Time wake = std::min(time_of(next_.at()), time_of(reschedule_at_));
  // While no command can come, refreshes are caught up with later: they change nothing that anyone could see.
  if (!next_.none()) wake = std::min(wake, time_of(refresh_at_));
  if (returns_.size > 0) {
    const Return& first = returns_.slots[returns_.head];
    wake = std::min(wake, std::max({next, time_of(first.due), ports_out_[first.port]->push_at()}));
  }
  ports_in_.each([&](const sim::Link<MemRequest>& in) {
    const bool room = in.pop_at() > now || !(in.front().write ? writes_ : reads_).full();
    if (room) wake = std::min(wake, std::max(next, in.pop_at()));
  });
  return wake;
}

void DramChannel::reschedule(Cycle now) {
  next_is_stale_ = false;
  reschedule_at_ = sim::kNever;
  for (const DramQueue* queue : {&reads_, &writes_}) {
    if (!queue->empty() && !overdue(*queue, now))
      reschedule_at_ = std::min(reschedule_at_, queue->oldest().arrived + controller_.age_limit);
  }
  writing_ = writes_first(now);
  const DramQueue& queue = writing_ ? writes_ : reads_;
  const bool blocked = !writing_ && returns_.full();
  next_ = queue.empty() || blocked ? ScheduledCommand{} : best_command(queue, now);
  waiting_ = queue.empty() ? CycleReason::kIdle
             : blocked     ? CycleReason::kReturnsFull
                           : device_.reason(next_.command(), next_.bank(), writing_, next_.at());
}

inline bool DramChannel::writes_first(Cycle now) {
  if (writes_.size() >= controller_.write_high) draining_ = true;
  if (writes_.size() <= controller_.write_low) draining_ = false;
  if (reads_.empty() || writes_.empty()) return reads_.empty();
  const bool old_read = overdue(reads_, now), old_write = overdue(writes_, now);
  if (old_read && old_write) return writes_.oldest().arrived < reads_.oldest().arrived;
  return old_read == old_write ? draining_ : old_write;
}

ScheduledCommand DramChannel::best_command(const DramQueue& queue, Cycle now) const {
  const bool in_turn = controller_.scheduler == DramScheduler::kFcfs;
  std::uint32_t banks = queue.banks(), columns = queue.hit_banks();
  if (in_turn || overdue(queue, now)) {
    const std::uint32_t first = 1U << queue.oldest().address.bank;
    if ((queue.hits(queue.oldest().address.bank) & 1) == 0) columns &= ~first;
    if (in_turn) banks = first;
  }
  const std::uint32_t open = device_.open_mask();
  ScheduledCommand best;
  for (std::uint32_t rank = 0; rank < ranks_; ++rank) {
    const DramDevice::ReadyCycles rank_ready = device_.rank_ready(rank, writing_, now);
    const std::uint32_t here = banks & device_.banks_of(rank);
    const auto consider = [&]<DramCommand command>(std::uint32_t of) {
      const Cycle from = rank_ready.back(), lead = device_.lead(command);
      const auto bound = [&](Cycle ready) {
        return ScheduledCommand(std::max(from + lead, ready) - lead, command, 0, 0);
      };
      if (best < bound(rank_ready[static_cast<std::size_t>(command)])) return;  // none can come before it
      for (std::uint32_t left = of; left != 0; left &= left - 1) {
        const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
        const Cycle ready = device_.ready(command, bank, writing_, rank_ready);
        if (best < bound(ready)) continue;
        const std::uint64_t positions = command == DramCommand::kColumn ? queue.hits(bank) : queue.waiting(bank);
        const auto position = static_cast<std::uint32_t>(std::countr_zero(positions));
        best = std::min(best, ScheduledCommand(device_.earliest(command, bank, ready, from), command, position, bank));
      }
    };
    consider.template operator()<DramCommand::kColumn>(here & columns);
    consider.template operator()<DramCommand::kActivate>(here & ~columns & ~open);
    consider.template operator()<DramCommand::kPrecharge>(here & ~columns & open);
  }
  return best;
}

inline void DramChannel::issue(Cycle now) {
  DramQueue& queue = writing_ ? writes_ : reads_;
  DramQueue::Entry& entry = queue.at(next_.position());
  const DramAddress address = entry.address;
  switch (next_.command()) {
    case DramCommand::kColumn:
      transfer(entry, now);
      queue.remove(next_.position());
      if ((reads_.hits(address.bank) | writes_.hits(address.bank)) == 0) row_done(address);
      break;
    case DramCommand::kActivate:
      entry.activated = true;
      stats_.activates += 1;
      if (book_ != nullptr) [[unlikely]]
        book_->count(entry.request.owner, &TileAccount::activates);
      device_.activate(address.bank, address.row, now);
      reads_.row_opened(address.bank, address.row);
      writes_.row_opened(address.bank, address.row);
      break;
    case DramCommand::kPrecharge:
      entry.precharged = true;
      device_.precharge(address.bank, now);
      reads_.row_closed(address.bank);
      writes_.row_closed(address.bank);
      break;
  }
}

/// The last queued hit of the row is on its way.
inline void DramChannel::row_done(const DramAddress& address) {
  const bool others = (reads_.waiting(address.bank) | writes_.waiting(address.bank)) != 0;
  if (page_policy_.closes(address.bank, address.row, others)) device_.auto_precharge(address.bank);
}

void DramChannel::show(const MemRequest& request, sim::Time end) const {
  if (watcher_ != nullptr) watcher_->served(request, end);
  if (book_ != nullptr)
    book_->count(request.owner, request.write ? &TileAccount::dram_writes : &TileAccount::dram_reads);
}

/// Moves the request's line over the data bus.
inline void DramChannel::transfer(const DramQueue::Entry& entry, Cycle now) {
  const MemRequest& r = entry.request;
  const Cycle data = r.write ? device_.write(entry.address.bank, now) : device_.read(entry.address.bank, now);
  const Cycle end = data + device_.data_cycles();
  data_end_ = std::max(data_end_, end);
  if (is_watched_) [[unlikely]]
    show(r, end * clock_.period());
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

std::string DramChannel::state() const {
  return fmt::format("{} reads and {} writes queued, {} lines to return, {} banks open, {}", reads_.size(),
                     writes_.size(), returns_.size, device_.open_banks(), writing_ ? "writing" : "reading");
}

}  // namespace hw
