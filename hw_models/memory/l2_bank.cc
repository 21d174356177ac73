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
      observer_(links.observer),
      channels_(channels),
      clock_(clock),
      index_(index),
      targets_(config.targets),
      writes_(config.writes),
      sector_bytes_(config.cache.line.bytes / 8),
      store_(config),
      misses_(config.mshrs_per_bank()),
      hits_(config.cache.hit_cycles + 1, config.cache.hit_cycles, clock),
      unsent_capacity_(2 * config.mshrs_per_bank() + 2),
      unsent_(unsent_capacity_ + 1, config.lookup_cycles, clock),
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
  bool served = send_reply(now);
  if (!filled_.has_waiters() && channels_in_.pop_at() <= now) {
    take_fill(now);
    served = true;
  }
  if (!unsent_.empty()) send_to_memory(now);
  served |= take_request(now);
  if (flush_in_ != nullptr) served |= flush_line(now);
  const sim::Time wake = next_wake(now);
  const CycleReason then = served && wake == now + clock_.period() ? CycleReason::kServing : wait_reason(now);
  activity_.spend(now, clock_.period(), served ? CycleReason::kServing : then, then);
  return wake;
}

void L2Bank::finish(sim::Time end) {
  activity_.finish(end);
  stats_.latency = clock_.cycles(read_time_.sum_at(end));
  stats_.memory_cycles = clock_.cycles(memory_time_.sum_at(end));
  stats_.line_cycles = clock_.cycles(line_time_.sum_at(end));
}

bool L2Bank::idle() const {
  const bool dirty = store_.dirty_lines() != 0 && flush_in_ != nullptr;
  return !dirty && !head_.full && !filled_.has_waiters() && misses_.empty() && unsent_.empty() && hits_.empty();
}

/// Sends one line per cycle from the L2 bank to a core. Requests that waited for the last fill are served before hits.
inline bool L2Bank::send_reply(sim::Time now) {
  const std::uint16_t core = reply_core(now);
  if (core == kNoCore || !cores_out_[core]->can_push(now)) return false;
  if (filled_.has_waiters()) {
    const Waiter& waiter = filled_.next_waiter();
    cores_out_[core]->push(now, {filled_.line, waiter.source, waiter.tag});
    read_time_.note_departure(waiter.arrived, now);
    filled_.next += 1;
  } else {
    const Reply hit = hits_.pop(now);
    cores_out_[core]->push(now, hit.response);
    read_time_.note_departure(hit.arrived, now);
  }
  return true;
}

/// Fills a line from memory into the L2 bank. The requests that wait for the line are answered from the next cycle on.
void L2Bank::take_fill(sim::Time now) {
  const std::uint32_t channel = channels_turn_.choose_requester(
      channels_in_.nonempty_mask(), [&](std::uint32_t i) { return channels_in_.can_pop(i, now); },
      [](std::uint32_t) { return sim::Time{0}; });
  channels_turn_.note_served(channel);
  const Addr line = channels_in_[channel].pop(now).line;
  const Waiters& waiters = misses_.release(line);
  filled_ = {line, 0, waiters.count, &waiters};
  line_time_.note_departure(waiters.list[0].missed, now);
  for (std::uint32_t i = 0; i < waiters.count; ++i) memory_time_.note_departure(waiters.list[i].missed, now);
  write_back_victim(now, store_.allocate(line, kWholeLine, waiters.dirty), waiters.tile);
  if (observer_ != nullptr) [[unlikely]]
    notify(*observer_, L2Filled{waiters.tile});
  stats_.fills += 1;
}

inline void L2Bank::send_to_memory(sim::Time now) {
  if (!unsent_.can_pop(now)) return;
  sim::Link<MemRequest>& channel = channel_of(unsent_.front());
  if (!channel.can_push(now)) return;
  channel.push(now, unsent_.pop(now));
}

/// Queues a request from the L2 bank to memory. The request can leave when the look-up latency has passed.
void L2Bank::queue_to_memory(sim::Time now, const MemRequest& request) {
  unsent_.push(now, request);
  if (request.write)
    stats_.bytes_to_memory += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(request.sectors));
}

void L2Bank::write_back_victim(sim::Time now, const L2Store::Victim& victim, TileTag tile) {
  if (victim.sectors == 0) return;
  queue_to_memory(now, MemRequest{victim.line, index_, 0, true, victim.sectors, tile});
  stats_.written_back += 1;
}

/// Moves a request to the head of the L2 bank's queue if the head is empty. Then processes the head unless it is
/// blocked.
inline bool L2Bank::take_request(sim::Time now) {
  const bool waited = head_.full;
  if (waited && waits_for_fill()) return false;
  if (!waited) {
    const std::uint32_t core = cores_.choose_requester(
        cores_in_.nonempty_mask(), [&](std::uint32_t i) { return cores_in_.can_pop(i, now); },
        [&](std::uint32_t i) { return cores_in_.pop_at(i); });
    if (core == cores_.requester_count()) return false;
    cores_.note_served(core);
    head_.arrived = cores_in_.pop_at(core);
    head_.request = cores_in_[core].pop(now);
    head_.core = static_cast<std::uint16_t>(core);
    head_.needs_mshr = false;
    if (!head_.request.write) read_time_.note_arrival(head_.arrived);
  }
  head_.full = !(head_.request.write ? process_write(now) : process_read(now));
  return !waited || !head_.full;
}

inline bool L2Bank::process_read(sim::Time now) {
  if (!hits_.can_push(now)) return false;
  const MemRequest& r = head_.request;
  const L2Store::LookupResult found = store_.look_up(r.line, r.sectors);
  if (found == L2Store::LookupResult::kAll) {
    hits_.push(now, Reply{{r.line, r.source, r.tag}, head_.core, head_.arrived});
    if (observer_ != nullptr) [[unlikely]]
      notify(*observer_, L2LookedUp{r.tile, true, now});
    stats_.hits += 1;
  } else {
    Waiters* waiters = misses_.find_payload(r.line);
    if (waiters == nullptr ? misses_.is_full() || !has_room_to_memory(2) : waiters->count == targets_) {
      head_.needs_mshr = misses_.is_full();
      return false;
    }
    if (waiters == nullptr) {
      waiters = &misses_.allocate(r.line);
      line_time_.note_arrival(now);
      waiters->count = 0;
      waiters->dirty = 0;
      waiters->tile = r.tile;
      if (found == L2Store::LookupResult::kPart) waiters->dirty = store_.invalidate_line(r.line);
      queue_to_memory(now, MemRequest{r.line, index_, 0, false, kWholeLine, r.tile});
    } else {
      stats_.merges += 1;
    }
    waiters->list[waiters->count++] = {head_.core, r.source, r.tag, head_.arrived, now};
    memory_time_.note_arrival(now);
    if (observer_ != nullptr) [[unlikely]]
      notify(*observer_, L2LookedUp{r.tile, false, now});
    stats_.misses += 1;
  }
  stats_.reads += 1;
  return true;
}

inline L2Bank::CycleReason L2Bank::wait_reason(sim::Time now) const {
  const std::uint16_t core = reply_core(now);
  if (core != kNoCore && !cores_out_[core]->can_push(now)) return CycleReason::kOutputFull;
  if (head_.full) {
    const bool to_memory = head_.request.write || (!misses_.is_full() && !has_room_to_memory(2));
    return to_memory ? CycleReason::kMemoryFull : CycleReason::kMshrFull;
  }
  if (!hits_.empty() || (!unsent_.empty() && !unsent_.can_pop(now))) return CycleReason::kLookup;
  if (!misses_.empty()) return CycleReason::kMemory;
  return !unsent_.empty() || (flushing_ && store_.dirty_lines() != 0) ? CycleReason::kMemoryFull : CycleReason::kIdle;
}

inline sim::Time L2Bank::next_wake(sim::Time now) const {
  const sim::Time next = now + clock_.period();
  sim::Time wake = sim::kNever;
  const auto at = [&](sim::Time time) { wake = std::min(wake, time); };
  if (const std::uint16_t core = reply_core(now); core != kNoCore) {
    at(cores_out_[core]->push_at());
  } else {
    at(hits_.pop_at());
  }
  if (!filled_.has_waiters()) at(channels_in_.pop_at());
  if (!head_.full) {
    at(cores_in_.pop_at());
  } else if (!hits_.can_push(now) && !head_.request.write) {
    at(hits_.push_at());
  }  // otherwise the head waits for a fill or for memory, and is looked up again at that tick
  if (flush_in_ != nullptr) at(flush_in_->pop_at());
  if (flushing_ && store_.dirty_lines() != 0 && has_room_to_memory(1)) at(next);
  at(unsent_.can_pop(now) ? channel_of(unsent_.front()).push_at() : unsent_.pop_at());
  return std::max(next, wake);
}

std::string L2Bank::state() const {
  return fmt::format(
      "{} lines under way, head {}, {} hits in the pipe, {} requests to memory to send, {} waiters to answer, "
      "{} dirty lines",
      misses_.size(), head_.full ? "waits" : "empty", hits_.size(), unsent_.size(), filled_.count - filled_.next,
      store_.dirty_lines());
}

/// Executes the write at the head of the queue by the L2's write policy. Returns false if the write must wait.
bool L2Bank::process_write(sim::Time now) {
  if (!has_room_to_memory(1)) return false;
  const MemRequest& r = head_.request;
  if (writes_ == L2Writes::kBack) {
    store_write(now);
  } else {
    const bool here = store_.look_up(r.line, r.sectors) != L2Store::LookupResult::kNot;
    const bool stored = here && writes_ == L2Writes::kThrough;
    if (here && !stored) store_.invalidate_line(r.line);
    stats_.write_hits += here;
    (stored ? stats_.stored : stats_.not_stored) += 1;
    queue_to_memory(now, MemRequest{r.line, index_, 0, true, r.sectors, r.tile});
    stats_.passed_on += 1;
  }
  if (observer_ != nullptr) [[unlikely]]
    notify(*observer_, L2Written{r.tile});
  stats_.writes += 1;
  stats_.bytes_written += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(r.sectors));
  return true;
}

/// Stores the write at the head of the L2 bank's queue in the cache (write-back).
void L2Bank::store_write(sim::Time now) {
  const MemRequest& r = head_.request;
  SectorMask overwritten = 0;
  bool hit = true;
  if (Waiters* waiters = misses_.find_payload(r.line)) {
    overwritten = waiters->dirty & r.sectors;
    waiters->dirty |= r.sectors;
  } else if (store_.look_up(r.line, r.sectors) != L2Store::LookupResult::kNot) {
    overwritten = store_.write_sectors(r.line, r.sectors);
  } else {
    hit = false;
    write_back_victim(now, store_.allocate(r.line, r.sectors, r.sectors), r.tile);
  }
  stats_.write_hits += hit;
  stats_.stored += 1;
  stats_.bytes_overwritten += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(overwritten));
}

/// After a Flush, writes one dirty line per cycle to memory. Returns true if a line was written.
bool L2Bank::flush_line(sim::Time now) {
  if (flush_in_->can_pop(now)) {
    flush_in_->pop(now);
    flushing_ = true;
  }
  if (!flushing_ || store_.dirty_lines() == 0 || !has_room_to_memory(1)) return false;
  write_back_victim(now, store_.clean_next_dirty_line());
  return true;
}

/// Ticks an ideal L2 bank, which accepts any number of requests per cycle. Cores do not delay each other.
sim::Time L2Bank::tick_ideal(sim::Time now) {
  bool served = false;
  CycleReason then = CycleReason::kIdle;
  sim::Time wake = sim::kNever;
  for (std::size_t core = 0; core < ideal_.size(); ++core) {
    sim::Link<MemRequest>& in = cores_in_[core];
    sim::Link<Reply>& pipe = ideal_[core];
    sim::Link<MemResponse>& out = *cores_out_[core];
    for (; pipe.can_pop(now) && out.can_push(now); served = true) {
      const Reply hit = pipe.pop(now);
      out.push(now, hit.response);
      read_time_.note_departure(hit.arrived, now);
    }
    for (; in.can_pop(now) && pipe.can_push(now); served = true) {
      const sim::Time arrived = in.pop_at();
      const MemRequest r = in.pop(now);
      if (r.write) {
        if (observer_ != nullptr) notify(*observer_, L2Written{r.tile});
        stats_.writes += 1;
        stats_.write_hits += 1;
        stats_.stored += 1;
        stats_.bytes_written += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(r.sectors));
      } else {
        pipe.push(now, Reply{{r.line, r.source, r.tag}, static_cast<std::uint16_t>(core), arrived});
        read_time_.note_arrival(arrived);
        if (observer_ != nullptr) notify(*observer_, L2LookedUp{r.tile, true, now});
        stats_.reads += 1;
        stats_.hits += 1;
      }
    }
    if (pipe.can_pop(now)) {
      then = CycleReason::kOutputFull;
    } else if (pipe.pop_at() != sim::kNever && then == CycleReason::kIdle) {
      then = CycleReason::kLookup;
    }
    const sim::Time next = now + clock_.period();
    wake = std::min(wake, sim::next_transfer_time(now, clock_.period(), in.pop_at(), pipe.push_at()));
    wake = std::min(wake, sim::next_transfer_time(now, clock_.period(), pipe.pop_at(), std::max(next, out.push_at())));
  }
  activity_.spend(now, clock_.period(), served ? CycleReason::kServing : then, then);
  return wake;
}

}  // namespace hw
