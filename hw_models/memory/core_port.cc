#include "hw_models/memory/core_port.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include <fmt/format.h>

namespace hw {

CorePort::CorePort(const InterconnectConfig& config, Links links, Interleave targets, sim::Clock clock,
                   std::uint64_t line_bytes, bool ideal)
    : clients_out_(std::move(links.clients_out)),
      targets_out_(std::move(links.targets_out)),
      clients_in_(std::move(links.clients_in)),
      targets_in_(std::move(links.targets_in)),
      requesters_(std::move(links.requesters)),
      observer_(links.observer),
      targets_(targets),
      clock_(clock),
      ideal_(ideal),
      up_(config.arbitration, clients_in_.size()),
      down_(config.arbitration, targets_in_.size()) {
  for (std::size_t eighths = 0; eighths < carry_time_.size(); ++eighths) {
    carry_time_[eighths] = (ideal ? 1 : config.cycles_of(line_bytes * eighths / 8)) * clock.period();
  }
  assert(clients_in_.size() == clients_out_.size());
  assert(targets_in_.size() == targets_out_.size());
}

sim::Time CorePort::tick(sim::Time now) {
  account_until(now);
  const bool requested = clients_in_.nonempty_mask() != 0 && send_requests_to_memory(now);
  if (targets_in_.nonempty_mask() != 0) send_lines_to_clients(now);
  const sim::Time next = now + clock_.period();
  const sim::Time wake = find_next_wake(now);
  const auto why_at = [&](sim::Time at, CycleReason otherwise) {
    return at < line_transfer_end_ ? CycleReason::kLine : otherwise;
  };
  activity_.spend(now, clock_.period(), why_at(now, requested ? CycleReason::kRequest : waiting_),
                  why_at(next, waiting_));
  return wake;
}

void CorePort::finish(sim::Time end) {
  account_until(end);
  activity_.finish(end);
  stats_.request_wait = clock_.cycles(request_wait_);
  stats_.line_wait = clock_.cycles(line_wait_);
}

/// If a line transfer of the core port has ended since the last tick, charges the cycles after its end to the reason
/// for waiting.
inline void CorePort::account_until(sim::Time until) {
  if (line_transfer_end_ >= activity_.accounted_until() && line_transfer_end_ < until)
    activity_.spend(line_transfer_end_, clock_.period(), waiting_, waiting_);
}

inline bool CorePort::send_requests_to_memory(sim::Time now) {
  if (ideal_) {
    bool any = false;
    for (std::uint32_t client = 0; client < up_.requester_count(); ++client) {
      for (; can_send_request(client, now); any = true) send_request(client, now);
    }
    return any;
  }
  if (up_free_ > now) return false;
  const std::uint32_t client = up_.choose_requester(
      clients_in_.nonempty_mask(), [&](std::uint32_t i) { return can_send_request(i, now); },
      [&](std::uint32_t i) { return clients_in_.pop_at(i); });
  if (client == up_.requester_count()) return false;
  send_request(client, now);
  up_.note_served(client);
  return true;
}

inline void CorePort::send_request(std::uint32_t client, sim::Time now) {
  request_wait_ += now - clients_in_.pop_at(client);
  const MemRequest request = clients_in_[client].pop(now);
  target_of(request).push(now, request);
  up_free_ = now + clock_.period();
  if (request.write) {
    up_free_ = now + carry_time_[static_cast<std::size_t>(std::popcount(request.sectors))];
    line_transfer_end_ = std::max(line_transfer_end_, up_free_);
  }
  if (observer_ != nullptr) [[unlikely]]
    notify(*observer_, LineRequested{request.tile, requesters_[client]});
  stats_.requests += 1;
  stats_.lines_up += request.write;
}

[[gnu::always_inline]] inline void CorePort::send_lines_to_clients(sim::Time now) {
  if (ideal_) {
    for (std::uint32_t target = 0; target < down_.requester_count(); ++target) {
      while (can_send_line(target, now)) send_line(target, now);
    }
    return;
  }
  if (down_free_ > now) return;
  const std::uint32_t target = down_.choose_requester(
      targets_in_.nonempty_mask(), [&](std::uint32_t i) { return can_send_line(i, now); },
      [&](std::uint32_t i) { return targets_in_.pop_at(i); });
  if (target == down_.requester_count()) return;
  send_line(target, now);
  down_.note_served(target);
}

inline void CorePort::send_line(std::uint32_t target, sim::Time now) {
  sim::Link<MemResponse>& in = targets_in_[target];
  line_wait_ += now - targets_in_.pop_at(target);
  clients_out_[in.front().source]->push(now, in.pop(now));
  down_free_ = now + carry_time_.back();
  line_transfer_end_ = std::max(line_transfer_end_, down_free_);
  stats_.lines_down += 1;
}

/// Returns the earliest time at which the core port may forward another message. Stores the reason to which the cycles
/// until then are charged.
[[gnu::always_inline]] inline sim::Time CorePort::find_next_wake(sim::Time now) {
  sim::Time wake = sim::kNever;
  waiting_ = CycleReason::kIdle;
  // The content of a message must not be read before the message is visible. The port wakes at that time.
  const auto consider = [&](const auto& all, sim::Time free_at, auto&& out_of, CycleReason full) {
    for (std::uint64_t left = all.nonempty_mask(); left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(left));
      sim::Time at = std::max(all.pop_at(i), free_at);
      if (all.pop_at(i) <= now) {
        const sim::Time room_at = out_of(all[i].front()).push_at();
        if (room_at > now) waiting_ = full;
        at = std::max(at, room_at);
      }
      wake = std::min(wake, at);
    }
  };
  consider(
      clients_in_, up_free_, [&](const MemRequest& r) -> auto& { return target_of(r); }, CycleReason::kTargetFull);
  consider(
      targets_in_, down_free_, [&](const MemResponse& r) -> auto& { return *clients_out_[r.source]; },
      CycleReason::kClientFull);
  return std::max(wake, now + clock_.period());
}

std::string CorePort::state() const {
  std::size_t requests = 0, lines = 0;
  clients_in_.for_each_nonempty([&](const sim::Link<MemRequest>& in) { requests += in.size(); });
  targets_in_.for_each_nonempty([&](const sim::Link<MemResponse>& in) { lines += in.size(); });
  return fmt::format("{} requests wait to go up, {} lines to come down", requests, lines);
}

}  // namespace hw
