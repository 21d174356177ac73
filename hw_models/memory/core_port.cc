#include "hw_models/memory/core_port.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>

namespace hw {

CorePort::CorePort(const InterconnectConfig& config, Links links, Interleave targets, sim::Clock clock,
                   std::uint64_t line_bytes)
    : links_(std::move(links)),
      targets_(targets),
      clock_(clock),
      line_time_(config.cycles_of(line_bytes) * clock.period()) {
  assert(links_.clients_in.size() == links_.clients_out.size());
  assert(links_.targets_in.size() == links_.targets_out.size());
}

sim::Time CorePort::tick(sim::Time now) {
  settle(now);
  const bool requested = send_up(now);
  carry_down(now);
  waiting_ = waiting(now);
  const auto why_at = [&](sim::Time at, Why otherwise) { return at < line_until_ ? Why::kLine : otherwise; };
  const sim::Time next = now + clock_.period();
  activity_.spend(now, clock_.period(), why_at(now, requested ? Why::kRequest : waiting_), why_at(next, waiting_));
  return next_wake(now);
}

void CorePort::finish(sim::Time end) {
  settle(end);
  activity_.finish(end);
}

/// The line that was under way at the last tick may be over since: no tick was needed to see it go.
void CorePort::settle(sim::Time until) {
  if (line_until_ > activity_.accounted() && line_until_ < until)
    activity_.spend(line_until_, clock_.period(), waiting_, waiting_);
}

bool CorePort::send_up(sim::Time now) {
  if (up_free_ > now) return false;
  const auto clients = static_cast<std::uint32_t>(links_.clients_in.size());
  for (std::uint32_t i = 0, client = client_turn_; i < clients; ++i, client = client + 1 == clients ? 0 : client + 1) {
    sim::Link<MemRequest>& in = *links_.clients_in[client];
    if (!in.can_pop(now)) continue;
    sim::Link<MemRequest>& target = target_of(in.front());
    if (!target.can_push(now)) continue;
    const MemRequest request = in.pop(now);
    target.push(now, request);
    client_turn_ = client + 1 == clients ? 0 : client + 1;
    up_free_ = now + (request.write ? line_time_ : clock_.period());
    if (request.write) line_until_ = std::max(line_until_, up_free_);
    stats_.requests += 1;
    stats_.lines_up += request.write;
    return true;
  }
  return false;
}

void CorePort::carry_down(sim::Time now) {
  if (down_free_ > now) return;
  const auto targets = static_cast<std::uint32_t>(links_.targets_in.size());
  for (std::uint32_t i = 0, target = target_turn_; i < targets; ++i, target = target + 1 == targets ? 0 : target + 1) {
    sim::Link<MemResponse>& in = *links_.targets_in[target];
    if (!in.can_pop(now)) continue;
    sim::Link<MemResponse>& client = *links_.clients_out[in.front().source];
    if (!client.can_push(now)) continue;
    client.push(now, in.pop(now));
    target_turn_ = target + 1 == targets ? 0 : target + 1;
    down_free_ = now + line_time_;
    line_until_ = std::max(line_until_, down_free_);
    stats_.lines_down += 1;
    return;
  }
}

CorePort::Why CorePort::waiting(sim::Time now) const {
  for (const sim::Link<MemResponse>* in : links_.targets_in) {
    if (in->can_pop(now) && !links_.clients_out[in->front().source]->can_push(now)) return Why::kClientFull;
  }
  for (const sim::Link<MemRequest>* in : links_.clients_in) {
    if (in->can_pop(now) && !target_of(in->front()).can_push(now)) return Why::kTargetFull;
  }
  return Why::kIdle;
}

sim::Time CorePort::next_wake(sim::Time now) const {
  sim::Time wake = sim::kNever;
  const auto consider = [&](const auto& in, sim::Time free_at, auto&& way_out) {
    const sim::Time at = in.pop_at();
    if (at == sim::kNever) return;
    // What is not visible yet must not be looked at: wake up for it and decide then.
    wake = std::min(wake, at > now ? at : std::max({now + clock_.period(), free_at, way_out(in.front()).push_at()}));
  };
  for (const sim::Link<MemRequest>* in : links_.clients_in)
    consider(
        *in, up_free_, [&](const MemRequest& r) -> const auto& { return target_of(r); });
  for (const sim::Link<MemResponse>* in : links_.targets_in)
    consider(
        *in, down_free_, [&](const MemResponse& r) -> const auto& { return *links_.clients_out[r.source]; });
  return wake;
}

std::string CorePort::state() const {
  std::size_t requests = 0, lines = 0;
  for (const sim::Link<MemRequest>* in : links_.clients_in) requests += in->size();
  for (const sim::Link<MemResponse>* in : links_.targets_in) lines += in->size();
  return fmt::format("{} requests wait to go up, {} lines to come down", requests, lines);
}

}  // namespace hw
