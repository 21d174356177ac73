#include "hw_models/tni/ist.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

using traces::ExitPhase;

Ist::Ist(const IstConfig& config, const TniMode& mode, const TrianglesInMemory& triangles, Links links,
         std::uint16_t client, sim::Clock clock)
    : config_(config),
      clock_(clock),
      triangles_(triangles),
      ideal_(mode.ideal),
      reorders_(mode.handling == MissHandling::kReorder && !mode.ideal_l1 && links.prefetches_in.empty()),
      known_after_{0, config.l1.hit_cycles + config.distance_stage, config.l1.hit_cycles + config.barycentric_stage,
                   config.l1.hit_cycles + config.latency},
      has_records_(!triangles.places.empty()),
      leaves_out_(std::move(links.leaves_out)),
      leaves_in_(std::move(links.leaves_in)),
      memory_out_(links.memory_out),
      memory_in_(links.memory_in),
      sources_(Arbitration::kRoundRobin, leaves_in_.size()),
      fetch_(config.l1, mode, client, waiting_[kToFetch]),
      slots_(config.leaves),
      pipe_(clock, config.l1.hit_cycles + config.latency),
      free_(first_slots_mask(config.leaves)) {
  memory_in_.store_pop_time_in(&line_at_);
  if (!links.prefetches_in.empty()) {
    prefetcher_.emplace(triangles_, std::move(links.prefetches_in));
    fetch_.count_prefetches();
  }
  stats_.has_prefetcher = prefetcher_.has_value();
}

Ist::Stats Ist::stats() const {
  Stats all = stats_;
  static_cast<FetchStats&>(all) = fetch_.stats();
  if (prefetcher_) {
    all.prefetch_probes = prefetcher_->stats().probes;
    all.prefetches = prefetcher_->stats().requests;
    all.prefetches_useful = fetch_.prefetch_counts().useful;
    all.prefetches_late = fetch_.prefetch_counts().late;
    all.prefetches_useless = fetch_.prefetch_counts().useless;
  }
  return all;
}

inline bool Ist::fill_arrived_line(const Cycle& cycle) {
  if (line_at_ > cycle.now) return false;
  fetch_.fill_line(memory_in_.pop(cycle.now).line, cycle.number);
  return true;
}

inline bool Ist::take_leaf(sim::Time now) {
  if (free_ == 0 || leaves_in_.nonempty_mask() == 0) return false;
  const std::uint32_t trv = sources_.choose_requester(
      leaves_in_.nonempty_mask(), [&](std::uint32_t i) { return leaves_in_.can_pop(i, now); },
      [](std::uint32_t) { return sim::Time{0}; });
  if (trv == sources_.requester_count()) return false;
  sources_.note_served(trv);
  const auto index = static_cast<std::uint32_t>(std::countr_zero(free_));
  free_ &= ~slot_bit(index);
  occupied_ |= slot_bit(index);
  waiting_[kToFetch] |= slot_bit(index);
  slots_[index] = Slot{leaves_in_[trv].pop(now), trv, 0, 0, 0};
  fetch_.set_slot_tile(index, slots_[index].job.tile);
  fetch_.prefetch_tags_on_host(line_of(triangles_.record_of(slots_[index].job.first)));
  stats_.leaves_in += 1;
  return true;
}

/// Returns a mask of the intersection unit's slots that may probe its L1 in this cycle.
inline std::uint64_t Ist::issuable_slot_mask() const {
  return reorders_ ? waiting_[kToFetch] : fetch_.issuable_slot_mask();
}

inline void Ist::complete_fetch(Slot& slot, std::uint32_t index, bool last_line, std::uint64_t cycle) {
  if (!last_line) {
    slot.lines += 1;
    waiting_[kToFetch] |= slot_bit(index);
    return;
  }
  const ExitPhase phase = traces::phase_of(slot.job.phases, slot.tested);
  stats_.tests += 1;
  stats_.edge_tests += phase != ExitPhase::kDistance;
  stats_.hits += phase == ExitPhase::kHit;
  slot.known_at = std::max(slot.known_at, cycle + known_after_[static_cast<std::size_t>(phase)]);
  slot.tested += 1;
  slot.lines = 0;
  if (slot.tested < slot.job.count) {
    waiting_[kToFetch] |= slot_bit(index);
  } else {
    pipe_.schedule_completion(kToAnswer, index, cycle, slot.known_at - cycle);
  }
}

[[gnu::always_inline]] inline Ist::CycleReason Ist::issue_test(std::uint64_t ready_slots, std::uint64_t cycle) {
  if (has_records_) return issue_record_test(ready_slots, cycle);
  const std::uint32_t index = round_robin(ready_slots, turn_);
  turn_ = (index + 1) % 64;
  Slot& slot = slots_[index];
  const Addr begin = triangles_.base + Addr{slot.job.first + slot.tested} * triangles_.bytes;
  const Addr last_line = line_of(begin + triangles_.bytes - 1);
  // Branch-free, because it is unpredictable whether the triangle's first or second line is read.
  const Addr line = line_of(begin + (triangles_.bytes - 1) * Addr{slot.lines});
  FetchStage::Wait wait = FetchStage::Wait::kNothing;
  if (reorders_ && fetch_.try_first_probe_hit(slot_bit(index), line)) {
    waiting_[kToFetch] &= ~slot_bit(index);
  } else {
    wait = fetch_.read_line(index, line, cycle);
  }
  if (wait == FetchStage::Wait::kNothing) {
    complete_fetch(slot, index, line == last_line, cycle);
    return CycleReason::kTesting;
  }
  return handle_miss(wait, index, cycle);
}

Ist::CycleReason Ist::issue_record_test(std::uint64_t ready_slots, std::uint64_t cycle) {
  if (cycle < decoder_free_at_ && !ideal_) return CycleReason::kTesting;
  const std::uint32_t index = round_robin(ready_slots, turn_);
  turn_ = (index + 1) % 64;
  Slot& slot = slots_[index];
  const std::uint32_t triangle = slot.job.first + slot.tested;
  const Addr begin = triangles_.record_of(triangle), last_line = line_of(begin + triangles_.bytes - 1);
  if (slot.tested > 0 && begin == triangles_.record_of(triangle - 1)) {
    waiting_[kToFetch] &= ~slot_bit(index);
    stats_.shared_tests += 1;
    complete_fetch(slot, index, true, cycle);
  } else {
    const Addr line = line_of(begin) + slot.lines * kLineBytes;
    if (reorders_ && fetch_.try_first_probe_hit(slot_bit(index), line)) {
      waiting_[kToFetch] &= ~slot_bit(index);
    } else if (const FetchStage::Wait wait = fetch_.read_line(index, line, cycle); wait != FetchStage::Wait::kNothing) {
      return handle_miss(wait, index, cycle);
    }
    complete_fetch(slot, index, line == last_line, cycle);
    if (line != last_line) return CycleReason::kTesting;
  }
  if (triangles_.decoded) {
    stats_.decoded += 1;
    decoder_free_at_ = cycle + config_.decode_interval;
  }
  return CycleReason::kTesting;
}

Ist::CycleReason Ist::handle_miss(FetchStage::Wait wait, std::uint32_t index, std::uint64_t cycle) {
  if (fetch_.is_bypassing()) {
    stats_.bypass_passes += 1;
    pipe_.schedule_completion(kToFetch, index, cycle, config_.l1.hit_cycles + config_.latency);
  }
  return FetchStage::wait_reason(wait, CycleReason::kL1Miss);
}

[[gnu::always_inline]] inline Ist::CycleReason Ist::issue_tests(std::uint64_t cycle) {
  CycleReason why = CycleReason::kStarved;  // the reason if no slot tries to issue
  for (std::uint64_t slots = issuable_slot_mask(); slots != 0; slots = ideal_ ? issuable_slot_mask() : 0) {
    const CycleReason one = issue_test(slots, cycle);
    if (why == CycleReason::kStarved || one == CycleReason::kTesting) why = one;
  }
  return why;
}

inline bool Ist::send_answer(sim::Time now) {
  if (waiting_[kToAnswer] == 0) return false;
  const std::uint32_t index = round_robin(waiting_[kToAnswer], answer_turn_);
  const Slot& slot = slots_[index];
  sim::Link<LeafDone>& out = *leaves_out_[slot.trv];
  assert(out.can_push(now) && "the ray's slot is its reserved return space");
  answer_turn_ = (index + 1) % 64;
  waiting_[kToAnswer] &= ~slot_bit(index);
  occupied_ &= ~slot_bit(index);
  free_ |= slot_bit(index);
  out.push(now, LeafDone{slot.job.slot});
  stats_.leaves_out += 1;
  return true;
}

inline Ist::CycleReason Ist::wait_reason() const {
  if (occupied_ == 0) return CycleReason::kStarved;
  if (waiting_[kToAnswer] != 0) return CycleReason::kOutputFull;
  return FetchStage::wait_reason(fetch_.scarcest_wait(), CycleReason::kPipe);
}

inline sim::Time Ist::next_wake(const Cycle& cycle) const {
  const sim::Time next = cycle.next;
  if ((issuable_slot_mask() | waiting_[kToAnswer]) != 0) return next;
  sim::Time at = pipe_.next_completion(cycle);
  if (free_ != 0) at = std::min(at, std::max(next, leaves_in_.pop_at()));
  at = std::min(at, std::max(next, line_at_));
  if (prefetcher_) at = std::min(at, prefetcher_->next_wake(fetch_, next));
  return std::min(at, fetch_.next_send_time(next, memory_out_));
}

sim::Time Ist::tick(const Cycle& cycle) {
  const sim::Time now = cycle.now;
  pipe_.take_completed(cycle.number, waiting_);
  if (line_at_ <= now) run_once_or_drain(ideal_, [&] { return fill_arrived_line(cycle); });
  run_once_or_drain(ideal_, [&] { return take_leaf(now); });
  const CycleReason tested = issue_tests(cycle.number);
  const bool tried = tested != CycleReason::kStarved;
  if (waiting_[kToAnswer] != 0) run_once_or_drain(ideal_, [&] { return send_answer(now); });
  if (prefetcher_) run_once_or_drain(ideal_, [&] { return prefetcher_->issue_prefetch(fetch_, cycle); });
  fetch_.send_request(now, memory_out_);
  const sim::Time wake = next_wake(cycle);
  const CycleReason then = tried && wake == cycle.next ? tested : wait_reason();
  activity_.spend(now, clock_.period(), tried ? tested : then, then);
  return wake;
}

std::string Ist::state() const {
  return fmt::format("leaves {}: ready {}, missing {}, no mshr {}, answering {}", std::popcount(occupied_),
                     std::popcount(waiting_[kToFetch]), std::popcount(fetch_.missing_slots()),
                     std::popcount(fetch_.slots_without_mshr()), std::popcount(waiting_[kToAnswer]));
}

}  // namespace hw
