#include "hw_models/memory/dram_channel.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

namespace hw {

namespace {

std::size_t most_bursts(const DramTiming& t) { return (std::max(t.rl + t.dqsck, t.wl) + 64) / t.burst + 4; }

}  // namespace

DramChannel::DramChannel(const DramConfig& c, Links links)
    : t_(c.timing),
      controller_(c.controller),
      map_(c),
      banks_in_use_(c.organisation.banks),
      group_mask_(c.organisation.bank_groups - 1),
      bursts_(c.bursts_per_line()),
      line_bytes_(c.line.bytes),
      fabric_((c.fabric.time + c.timing.ck.time - 1) / c.timing.ck.time),
      train_length_(Cycle{bursts_ - 1} * c.timing.ccd_l),
      data_train_(train(bursts_, c.timing.ccd_s, c.timing.ccd_l)),
      column_train_(train(bursts_, c.timing.ca_column, c.timing.ccd_l)),
      activate_slots_(train(1, c.timing.ca_activate, 0)),
      precharge_slots_(train(1, c.timing.ca_precharge, 0)),
      clock_(c.timing.ck.time),
      links_(std::move(links)),
      reads_(c.controller.read_queue),
      writes_(c.controller.write_queue),
      data_bus_(most_bursts(c.timing)),
      refresh_at_(c.timing.refi_pb == 0 ? sim::kNever : c.timing.refi_pb) {
  assert(links_.ports_in.size() == links_.ports_out.size());
  assert(banks_in_use_ <= kMaxBanks && c.organisation.bank_groups <= kMaxGroups);
  // Room for what a full data bus brings in while the fabric and the device delay it, and as much again.
  const Cycle in_flight = fabric_ + t_.rl + t_.dqsck + train_length_ + t_.burst;
  returns_.slots.resize(2 * (in_flight / (Cycle{bursts_} * t_.burst) + 4));
}

sim::Time DramChannel::tick(sim::Time now) {
  const Cycle cycle = clock_.cycles(now);
  settle(cycle);
  refresh(cycle);
  take_request(now, cycle);
  respond(now, cycle);
  if (plan_is_stale_ || cycle >= replan_at_) replan(cycle);
  if (plan_.at <= cycle) {
    issue(cycle);
    replan(cycle);
  }
  return next_wake(now);
}

void DramChannel::finish(sim::Time end) {
  const Cycle cycle = clock_.cycles(end);
  settle(cycle);
  activity_.finish(end);
  refresh(cycle);
  count_standby(cycle);
}

void DramChannel::take_request(sim::Time now, Cycle cycle) {
  const auto ports = static_cast<std::uint32_t>(links_.ports_in.size());
  for (std::uint32_t i = 0, port = port_turn_; i < ports; ++i, port = port + 1 == ports ? 0 : port + 1) {
    sim::Link<MemRequest>& in = *links_.ports_in[port];
    if (!in.can_pop(now)) continue;
    DramQueue& queue = in.front().write ? writes_ : reads_;
    if (queue.full()) continue;
    const MemRequest request = in.pop(now);
    const DramPlace place = map_.place(request.line);
    const Bank& bank = banks_[place.bank];
    queue.push({request, place, cycle, static_cast<std::uint16_t>(port)}, bank.open && bank.row == place.row);
    port_turn_ = port + 1 == ports ? 0 : port + 1;
    plan_is_stale_ = true;
    return;
  }
}

void DramChannel::respond(sim::Time now, Cycle cycle) {
  if (returns_.size == 0) return;
  const Return& first = returns_.slots[returns_.head];
  sim::Link<MemResponse>& out = *links_.ports_out[first.port];
  if (first.due > cycle || !out.can_push(now)) return;
  out.push(now, first.response);
  plan_is_stale_ |= returns_.size == returns_.slots.size();
  returns_.head = (returns_.head + 1) % returns_.slots.size();
  returns_.size -= 1;
}

sim::Time DramChannel::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  const auto time_of = [&](Cycle cycle) { return cycle == sim::kNever ? sim::kNever : cycle * clock_.period(); };
  sim::Time wake = std::min(time_of(plan_.at), time_of(replan_at_));
  // While no command can come, refreshes are caught up with later: they change nothing that anyone could see.
  if (plan_.command != Command::kNone) wake = std::min(wake, time_of(refresh_at_));
  if (returns_.size > 0) {
    const Return& first = returns_.slots[returns_.head];
    wake = std::min(wake, std::max({next, time_of(first.due), links_.ports_out[first.port]->push_at()}));
  }
  for (const sim::Link<MemRequest>* in : links_.ports_in) {
    const sim::Time at = in->pop_at();
    if (at == sim::kNever) continue;
    const bool room = at > now || !(in->front().write ? writes_ : reads_).full();
    if (room) wake = std::min(wake, std::max(next, at));
  }
  return wake;
}

bool DramChannel::Plan::before(const Plan& other) const {
  if (at != other.at) return at < other.at;
  if (command != other.command) return command < other.command;
  return place < other.place;
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
  const bool blocked = !writing_ && returns_.size == returns_.slots.size();
  plan_ = queue.empty() || blocked ? Plan{} : best_plan(queue, now);
  waiting_ = queue.empty() ? Why::kIdle : blocked ? Why::kReturnsFull : reason(plan_);
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

DramChannel::Plan DramChannel::best_plan(const DramQueue& queue, Cycle now) const {
  Plan best;
  const std::uint32_t overdue_bank = overdue(queue, now) ? queue.oldest().place.bank : kMaxBanks;
  const Cycle any_activate_at = std::max({now, activate_at_, four_activates_[oldest_activate_]});
  for (std::uint32_t left = queue.banks(); left != 0; left &= left - 1) {
    Plan plan;
    plan.bank = static_cast<std::uint32_t>(std::countr_zero(left));
    const Bank& bank = banks_[plan.bank];
    std::uint64_t hits = queue.hits(plan.bank);
    if (plan.bank == overdue_bank) hits &= 1;
    if (hits != 0) {
      plan.command = Command::kColumn;
      plan.place = static_cast<std::uint32_t>(std::countr_zero(hits));
      plan.at = column_at(plan.bank, now);
    } else {
      plan.place = static_cast<std::uint32_t>(std::countr_zero(queue.waiting(plan.bank)));
      plan.command = bank.open ? Command::kPrecharge : Command::kActivate;
      plan.at = bank.open ? command_bus_.first_free(std::max(now, bank.precharge_at), precharge_slots_)
                          : command_bus_.first_free(std::max(any_activate_at, bank.activate_at), activate_slots_);
    }
    if (plan.before(best)) best = plan;
  }
  return best;
}

DramChannel::Cycle DramChannel::direction_at(std::uint32_t bank) const {
  return writing_ ? write_at_ : std::max(read_at_, group_read_at_[group_of(bank)]);
}

DramChannel::Cycle DramChannel::column_at(std::uint32_t bank, Cycle from) const {
  Cycle at = std::max({from, banks_[bank].column_at, direction_at(bank), group_column_at_[group_of(bank)]});
  for (;;) {
    const Cycle data = column_slots_.first_free(at, data_train_);
    at = command_bus_.first_free(data, column_train_);
    if (at == data) return at;
  }
}

/// What kept the plan's command from running one cycle earlier: true for every cycle until then.
DramChannel::Why DramChannel::reason(const Plan& plan) const {
  const Bank& bank = banks_[plan.bank];
  switch (plan.command) {
    case Command::kColumn:
      if (plan.at == bank.column_at) return Why::kActivate;
      if (plan.at == direction_at(plan.bank)) return Why::kTurnaround;
      if (plan.at == group_column_at_[group_of(plan.bank)]) return Why::kColumn;
      return column_slots_.free(plan.at - 1, data_train_) ? Why::kCommandBus : Why::kColumn;
    case Command::kActivate:
      if (plan.at == bank.activate_at) return bank.closed_why;
      return plan.at == std::max(activate_at_, four_activates_[oldest_activate_]) ? Why::kActivate : Why::kCommandBus;
    case Command::kPrecharge:
      return plan.at == bank.precharge_at ? Why::kRowConflict : Why::kCommandBus;
    case Command::kNone:
      break;
  }
  return Why::kIdle;
}

void DramChannel::issue(Cycle now) {
  DramQueue& queue = writing_ ? writes_ : reads_;
  DramQueue::Entry& entry = queue.at(plan_.place);
  switch (plan_.command) {
    case Command::kColumn:
      writing_ ? write(entry, now) : read(entry, now);
      queue.remove(plan_.place);
      break;
    case Command::kActivate:
      activate(entry, now);
      break;
    case Command::kPrecharge:
      entry.precharged = true;
      command_bus_.book(now, precharge_slots_);
      close(plan_.bank, now);
      break;
    case Command::kNone:
      assert(false && "a plan has a command");
  }
}

std::string DramChannel::state() const {
  return fmt::format("{} reads and {} writes queued, {} lines to return, {} banks open, {}", reads_.size(),
                     writes_.size(), returns_.size, open_banks_, writing_ ? "writing" : "reading");
}

}  // namespace hw
