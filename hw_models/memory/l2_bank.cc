#include "hw_models/memory/l2_bank.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include <fmt/format.h>

namespace hw {

L2Bank::L2Bank(const L2Config& config, std::uint16_t index, Links links, Interleave channels, sim::Clock clock,
               Arbitration arbitration, bool ideal)
    : cores_out_(std::move(links.cores_out)),
      channels_out_(std::move(links.channels_out)),
      cores_in_(std::move(links.cores_in)),
      channels_in_(std::move(links.channels_in)),
      flush_in_(links.flush_in),
      book_(links.book),
      watcher_(links.watcher),
      channels_(channels),
      clock_(clock),
      is_watched_(book_ != nullptr || watcher_ != nullptr),
      index_(index),
      targets_(config.targets),
      writes_(config.writes),
      sector_bytes_(config.cache.line.bytes / 8),
      store_(config),
      misses_(config.mshrs_per_bank()),
      hits_(config.cache.hit_cycles + 1, config.cache.hit_cycles, clock),
      room_(2 * config.mshrs_per_bank() + 2),
      unsent_(room_ + 1, config.lookup_cycles, clock),
      cores_(arbitration, cores_in_.size()),
      channels_turn_(Arbitration::kRoundRobin, channels_in_.size()) {
  assert(cores_in_.size() == cores_out_.size());
  assert(channels_in_.size() == channels_out_.size());
  if (!ideal) return;
  for (std::size_t core = 0; core < cores_in_.size(); ++core) {
    ideal_.emplace_back(2 * cores_in_[core].capacity(), 1, clock);
  }
}

sim::Time L2Bank::tick(sim::Time now) {
  if (!ideal_.empty()) return tick_ideal(now);
  bool served = reply(now);
  served |= take_fill(now);
  if (queued_ != 0) send_to_memory(now);
  served |= take_request(now);
  if (flush_in_ != nullptr) served |= flush(now);
  const sim::Time wake = next_wake(now);
  const CycleReason then = served && wake == now + clock_.period() ? CycleReason::kServing : waiting(now);
  activity_.spend(now, clock_.period(), served ? CycleReason::kServing : then, then);
  return wake;
}

void L2Bank::finish(sim::Time end) {
  activity_.finish(end);
  // Reads that have not ended yet have lasted until now.
  std::uint64_t waiters = 0;
  misses_.each([&](const Waiters& of_line) { waiters += of_line.count; });
  std::uint64_t reads = waiters + hits_.size() + (filled_.count - filled_.next);
  if (head_.full && !head_.request.write) reads += 1;
  for (const sim::Link<MemResponse>& answers : ideal_) reads += answers.size();
  stats_.latency = clock_.cycles(latency_ + end * reads);
  stats_.memory_cycles = clock_.cycles(memory_time_ + end * waiters);
  stats_.line_cycles = clock_.cycles(line_time_ + end * misses_.size());
}

bool L2Bank::idle() const {
  const bool dirty = store_.dirty_lines() != 0 && flush_in_ != nullptr;
  return !dirty && !head_.full && !filled_.pending() && misses_.empty() && queued_ == 0 && hits_.empty();
}

/// One line per cycle leaves: first those of the last fill, then hits.
inline bool L2Bank::reply(sim::Time now) {
  const std::uint16_t core = reply_core(now);
  if (core == kNoCore || !cores_out_[core]->can_push(now)) return false;
  if (filled_.pending()) {
    const Waiter& waiter = filled_.first();
    cores_out_[core]->push(now, {filled_.line, waiter.source, waiter.tag});
    filled_.next += 1;
  } else {
    cores_out_[core]->push(now, hits_.pop(now).response);
  }
  latency_ += now;
  return true;
}

inline bool L2Bank::take_fill(sim::Time now) {
  if (filled_.pending() || channels_in_.holding() == 0) return false;
  const auto has_come = [&](std::uint32_t i) { return channels_in_.can_pop(i, now); };
  const std::uint32_t channel =
      channels_turn_.choose(channels_in_.holding(), has_come, [](std::uint32_t) { return sim::Time{0}; });
  if (channel == channels_turn_.count()) return false;
  channels_turn_.served(channel);
  const Addr line = channels_in_[channel].pop(now).line;
  const Waiters& waiters = misses_.release(line);
  filled_ = {line, 0, waiters.count, &waiters};
  line_time_ += now;
  memory_time_ += now * waiters.count;
  write_back(now, store_.put_in(line, kWholeLine, waiters.dirty), waiters.owner);
  if (book_ != nullptr) [[unlikely]]
    book_->count(waiters.owner, &TileAccount::l2_fills);
  stats_.fills += 1;
  return true;
}

inline void L2Bank::send_to_memory(sim::Time now) {
  if (!unsent_.can_pop(now)) return;
  sim::Link<MemRequest>& channel = channel_of(unsent_.front());
  if (!channel.can_push(now)) return;
  channel.push(now, unsent_.pop(now));
  queued_ -= 1;
}

void L2Bank::to_memory(sim::Time now, const MemRequest& request) {
  unsent_.push(now, request);
  queued_ += 1;
  if (request.write)
    stats_.bytes_to_memory += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(request.sectors));
}

void L2Bank::write_back(sim::Time now, const L2Store::Victim& victim, Owner owner) {
  if (victim.sectors == 0) return;
  to_memory(now, MemRequest{victim.line, index_, 0, true, victim.sectors, owner});
  stats_.written_back += 1;
}

inline bool L2Bank::take_request(sim::Time now) {
  if (head_.full) return look_up(now);
  const std::uint32_t core = cores_.choose(
      cores_in_.holding(), [&](std::uint32_t i) { return cores_in_.can_pop(i, now); },
      [&](std::uint32_t i) { return cores_in_.pop_at(i); });
  if (core == cores_.count()) return false;
  cores_.served(core);
  sim::Link<MemRequest>& in = cores_in_[core];
  if (!in.front().write) latency_ -= in.pop_at();
  head_ = {in.pop(now), static_cast<std::uint16_t>(core), true};
  look_up(now);
  return true;
}

/// Sends the head on its way; false if it must stay.
inline bool L2Bank::look_up(sim::Time now) {
  head_.full = !(head_.request.write ? write(now) : read(now));
  return !head_.full;
}

inline bool L2Bank::read(sim::Time now) {
  if (!hits_.can_push(now)) return false;
  const MemRequest& r = head_.request;
  const L2Store::Found found = store_.find(r.line, r.sectors);
  if (found == L2Store::Found::kAll) {
    hits_.push(now, Reply{{r.line, r.source, r.tag}, head_.core});
    if (is_watched_) [[unlikely]]
      show_read(true, r.owner, now);
    stats_.hits += 1;
  } else {
    Waiters* waiters = misses_.find(r.line);
    if (waiters == nullptr ? misses_.full() || !has_room(2) : waiters->count == targets_) return false;
    if (waiters == nullptr) {
      waiters = &misses_.allocate(r.line);
      line_time_ -= now;
      waiters->owner = r.owner;
      if (found == L2Store::Found::kPart) waiters->dirty = store_.take_out(r.line);
      to_memory(now, MemRequest{r.line, index_, 0, false, kWholeLine, r.owner});
    } else {
      stats_.merges += 1;
    }
    waiters->list[waiters->count++] = {head_.core, r.source, r.tag};
    memory_time_ -= now;
    if (is_watched_) [[unlikely]]
      show_read(false, r.owner, now);
    stats_.misses += 1;
  }
  stats_.reads += 1;
  return true;
}

void L2Bank::show_read(bool hit, Owner owner, sim::Time now) {
  if (watcher_ != nullptr) watcher_->looked_up(hit, now);
  if (book_ != nullptr) book_->count(owner, hit ? &TileAccount::l2_hits : &TileAccount::l2_misses);
}

inline L2Bank::CycleReason L2Bank::waiting(sim::Time now) const {
  const std::uint16_t core = reply_core(now);
  if (core != kNoCore && !cores_out_[core]->can_push(now)) return CycleReason::kOutputFull;
  if (head_.full) {
    const bool to_memory = head_.request.write || (!misses_.full() && !has_room(2));
    return to_memory ? CycleReason::kMemoryFull : CycleReason::kMshrFull;
  }
  if (!hits_.empty() || (!unsent_.empty() && !unsent_.can_pop(now))) return CycleReason::kLookup;
  if (!misses_.empty()) return CycleReason::kMemory;
  return queued_ != 0 || (flushing_ && store_.dirty_lines() != 0) ? CycleReason::kMemoryFull : CycleReason::kIdle;
}

inline sim::Time L2Bank::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  sim::Time wake = sim::kNever;
  const auto at = [&](sim::Time time) { wake = std::min(wake, time == sim::kNever ? time : std::max(next, time)); };
  if (const std::uint16_t core = reply_core(now); core != kNoCore) {
    at(cores_out_[core]->push_at());
  } else {
    at(hits_.pop_at());
  }
  if (!filled_.pending()) at(channels_in_.pop_at());
  if (!head_.full) {
    at(cores_in_.pop_at());
  } else if (!hits_.can_push(now) && !head_.request.write) {
    at(hits_.push_at());
  }  // else it waits for a fill or for memory to take something: that tick looks it up again
  if (flush_in_ != nullptr) at(flush_in_->pop_at());
  if (flushing_ && store_.dirty_lines() != 0 && has_room(1)) at(next);
  if (unsent_.can_pop(now)) {
    at(channel_of(unsent_.front()).push_at());
  } else {
    at(unsent_.pop_at());
  }
  return wake;
}

std::string L2Bank::state() const {
  return fmt::format(
      "{} lines under way, head {}, {} hits in the pipe, {} requests to memory to send, {} waiters to answer, "
      "{} dirty lines",
      misses_.size(), head_.full ? "waits" : "empty", hits_.size(), queued_, filled_.count - filled_.next,
      store_.dirty_lines());
}

}  // namespace hw
