#include "hw_models/memory/l2_bank.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include <fmt/format.h>

namespace hw {

L2Bank::L2Bank(const L2Config& config, std::uint16_t index, Links links, Interleave channels, sim::Clock clock)
    : links_(std::move(links)),
      channels_(channels),
      clock_(clock),
      index_(index),
      targets_(config.targets),
      tags_(config.cache, config.banks),
      misses_(config.mshrs_per_bank()),
      hits_(config.cache.hit_cycles + 1, config.cache.hit_cycles, clock),
      unsent_(config.mshrs_per_bank() + 1, config.lookup_cycles, clock) {
  assert(links_.cores_in.size() == links_.cores_out.size());
  assert(links_.channels_in.size() == links_.channels_out.size());
}

sim::Time L2Bank::tick(sim::Time now) {
  bool served = reply(now);
  served |= take_fill(now);
  served |= take_request(now);
  send_miss(now);
  const Why then = waiting(now);
  activity_.spend(now, clock_.period(), served ? Why::kServing : then, then);
  return next_wake(now);
}

/// One line per cycle leaves: first those of the last fill, then hits.
bool L2Bank::reply(sim::Time now) {
  const std::optional<Reply> next = next_reply(now);
  if (!next || !links_.cores_out[next->core]->can_push(now)) return false;
  links_.cores_out[next->core]->push(now, next->response);
  if (filled_.pending()) {
    filled_.next += 1;
  } else {
    hits_.pop(now);
  }
  return true;
}

std::optional<L2Bank::Reply> L2Bank::next_reply(sim::Time now) const {
  if (filled_.pending()) {
    const Waiter& waiter = filled_.waiters.list[filled_.next];
    return Reply{{filled_.line, waiter.source, waiter.tag}, waiter.core};
  }
  if (hits_.can_pop(now)) return hits_.front();
  return std::nullopt;
}

bool L2Bank::take_fill(sim::Time now) {
  if (filled_.pending()) return false;
  const auto channels = static_cast<std::uint32_t>(links_.channels_in.size());
  for (std::uint32_t i = 0, c = channel_turn_; i < channels; ++i, c = c + 1 == channels ? 0 : c + 1) {
    sim::Link<MemResponse>& in = *links_.channels_in[c];
    if (!in.can_pop(now)) continue;
    const Addr line = in.pop(now).line;
    filled_ = {line, 0, misses_.release(line)};
    tags_.fill(line);
    channel_turn_ = c + 1 == channels ? 0 : c + 1;
    stats_.fills += 1;
    return true;
  }
  return false;
}

bool L2Bank::take_request(sim::Time now) {
  if (head_.full) return look_up(now);
  const auto cores = static_cast<std::uint32_t>(links_.cores_in.size());
  for (std::uint32_t i = 0, core = core_turn_; i < cores; ++i, core = core + 1 == cores ? 0 : core + 1) {
    sim::Link<MemRequest>& in = *links_.cores_in[core];
    if (!in.can_pop(now)) continue;
    head_ = {in.pop(now), static_cast<std::uint16_t>(core), true};
    assert(!head_.request.write && "writes go around the L2");
    core_turn_ = core + 1 == cores ? 0 : core + 1;
    look_up(now);
    return true;
  }
  return false;
}

/// Sends the head on its way; false if it must stay.
bool L2Bank::look_up(sim::Time now) {
  if (!hits_.can_push(now)) return false;
  const MemRequest& r = head_.request;
  if (tags_.probe(r.line)) {
    hits_.push(now, Reply{{r.line, r.source, r.tag}, head_.core});
    stats_.hits += 1;
  } else {
    Waiters* waiters = misses_.find(r.line);
    if (waiters == nullptr ? misses_.full() : waiters->count == targets_) return false;
    if (waiters == nullptr) {
      waiters = &misses_.allocate(r.line);
      unsent_.push(now, MemRequest{r.line, index_, 0, false});
    } else {
      stats_.merges += 1;
    }
    waiters->list[waiters->count++] = {head_.core, r.source, r.tag};
    stats_.misses += 1;
  }
  stats_.reads += 1;
  head_.full = false;
  return true;
}

void L2Bank::send_miss(sim::Time now) {
  if (!unsent_.can_pop(now)) return;
  sim::Link<MemRequest>& channel = channel_of(unsent_.front());
  if (channel.can_push(now)) channel.push(now, unsent_.pop(now));
}

L2Bank::Why L2Bank::waiting(sim::Time now) const {
  const std::optional<Reply> next = next_reply(now);
  if (next && !links_.cores_out[next->core]->can_push(now)) return Why::kOutputFull;
  if (head_.full) return Why::kMshrFull;
  if (hits_.pop_at() != sim::kNever) return Why::kLookup;
  if (unsent_.pop_at() != sim::kNever && !unsent_.can_pop(now)) return Why::kLookup;
  return misses_.empty() ? Why::kIdle : Why::kMemory;
}

sim::Time L2Bank::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  sim::Time wake = sim::kNever;
  const auto at = [&](sim::Time time) { wake = std::min(wake, time == sim::kNever ? time : std::max(next, time)); };
  if (const std::optional<Reply> reply = next_reply(now)) {
    at(links_.cores_out[reply->core]->push_at());
  } else {
    at(hits_.pop_at());
  }
  if (!filled_.pending()) {
    for (const sim::Link<MemResponse>* in : links_.channels_in) at(in->pop_at());
  }
  if (!head_.full) {
    for (const sim::Link<MemRequest>* in : links_.cores_in) at(in->pop_at());
  } else if (!hits_.can_push(now)) {
    at(hits_.push_at());
  }  // else it waits for a fill, whose tick looks it up again
  if (unsent_.can_pop(now)) {
    at(channel_of(unsent_.front()).push_at());
  } else {
    at(unsent_.pop_at());
  }
  return wake;
}

std::string L2Bank::state() const {
  return fmt::format("{} lines under way, head {}, {} hits in the pipe, {} misses to send, {} waiters to answer",
                     misses_.size(), head_.full ? "waits" : "empty", hits_.size(), unsent_.size(),
                     filled_.waiters.count - filled_.next);
}

}  // namespace hw
