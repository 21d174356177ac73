#include "hw_models/tni/trv.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

using traces::StepKind;

namespace {

constexpr std::uint64_t bit(std::uint32_t slot) { return std::uint64_t{1} << slot; }
/// Nodes at which the `stacked` entries now on a ray's stack were pushed, oldest first, found by following its walk
/// from `begin` up to the step `next`. Restarts are rare; keeping such a list for every ray is not worth the memory.
std::vector<std::uint32_t> pending_pushes(const std::uint32_t* begin, const std::uint32_t* next, std::size_t stacked) {
  std::vector<std::uint32_t> entries;
  bool must_pop = false;
  for (const std::uint32_t* step = begin; step != next; ++step) {
    const StepKind kind = traces::kind_of(*step);
    if (kind == StepKind::kCull) {
      // The culls just before `next` are under way: `stacked` says how far.
      if (step + 1 != next) entries.resize(entries.size() - traces::culled_of(*step));
      continue;
    }
    if (must_pop) entries.pop_back();
    must_pop = kind == StepKind::kLeaf || traces::hits_of(*step) == 0;
    if (kind == StepKind::kLeaf) {
      ++step;  // its exit phases
    } else if (traces::hits_of(*step) == 3) {
      entries.push_back(traces::node_of(*step));
    }
  }
  entries.resize(stacked);
  return entries;
}

constexpr std::uint64_t all(std::uint32_t slots) { return slots == 64 ? ~std::uint64_t{0} : bit(slots) - 1; }

}  // namespace

Trv::Trv(const TrvConfig& config, const TreeInMemory& tree, Links links, std::uint16_t port, sim::Clock clock)
    : config_(config),
      clock_(clock),
      tree_(tree),
      visit_latency_(config.l1.hit_cycles + config.box_latency),
      links_(links),
      l1_(config.l1, port),
      slots_(config.rays),
      paths_(config.rays),
      pipes_(clock),
      free_(all(config.rays)) {
  assert(visit_latency_ < Wheel<kPipes>::kSpan);
}

sim::Time Trv::tick(sim::Time now) {
  pipes_.advance(now);
  release(pipes_.take());
  take_lines(now);
  take_answers(now);
  take_rays(now);
  const bool tried = ready_ != 0;
  const Why inner = tried ? issue_visit() : Why::kStarved;
  issue_pop();
  issue_leaf(now);
  retire(now);
  l1_.send(now, links_.memory_out);
  const Why then = waiting();
  activity_.spend(now, clock_.period(), tried ? inner : then, then);
  return next_wake(now);
}

void Trv::release(const Wheel<kPipes>::Masks& out) {
  ready_ |= out[kToInner];
  popping_ |= out[kToStack];
  leaving_ |= out[kToLeaf];
  retiring_ |= out[kToRetire];
}

void Trv::take_lines(sim::Time now) {
  if (!links_.memory_in.can_pop(now)) return;
  const std::uint64_t waited = l1_.fill(links_.memory_in.pop(now).line);
  stats_.l1_fills += 1;
  missing_ &= ~waited;
  served_ |= waited;
  ready_ |= waited | no_mshr_;  // a miss register is free again: those that found none try again
  no_mshr_ = 0;
}

void Trv::take_answers(sim::Time now) {
  if (!links_.leaves_in.can_pop(now)) return;
  const std::uint32_t index = links_.leaves_in.pop(now).slot;
  at_ist_ &= ~bit(index);
  Slot& slot = slots_[index];
  slot.must_pop = true;
  switch (next_pipe(slot)) {
    case kToStack:
      popping_ |= bit(index);
      break;
    case kToRetire:
      retiring_ |= bit(index);
      break;
    default:
      assert(false && "a leaf is followed by a pop or the end");
  }
}

void Trv::take_rays(sim::Time now) {
  if (free_ == 0 || !links_.rays_in.can_pop(now)) return;
  const RayJob job = links_.rays_in.pop(now);
  const auto index = static_cast<std::uint32_t>(std::countr_zero(free_));
  free_ &= ~bit(index);
  occupied_ |= bit(index);
  Slot& slot = slots_[index];
  slot = Slot{job.walk, job.walk, job.id};
  stats_.rays_in += 1;
  switch (next_pipe(slot)) {
    case kToInner:
      ready_ |= bit(index);
      break;
    case kToRetire:
      retiring_ |= bit(index);
      break;
    default:
      assert(false && "a walk begins with the root");
  }
}

Trv::Pipe Trv::next_pipe(Slot& slot) const {
  if (slot.restarting) return kToInner;
  if (traces::kind_of(*slot.next) == StepKind::kCull) {
    slot.culls = traces::culled_of(*slot.next);
    slot.next += 1;
  }
  if (slot.culls > 0) return kToStack;
  if (traces::kind_of(*slot.next) == StepKind::kEnd) return kToRetire;
  if (slot.must_pop) return kToStack;
  return traces::kind_of(*slot.next) == StepKind::kVisit ? kToInner : kToLeaf;
}

Trv::Why Trv::issue_visit() {
  const std::uint32_t index = pick(ready_, inner_turn_);
  inner_turn_ = (index + 1) % 64;
  ready_ &= ~bit(index);
  Slot& slot = slots_[index];
  const std::uint32_t node = slot.restarting ? paths_[index].back() : traces::node_of(*slot.next);
  const Addr line = (tree_.nodes + Addr{node} * tree_.node_bytes) & ~Addr{63};
  stats_.l1_accesses += 1;
  const bool served = (served_ & bit(index)) != 0;
  served_ &= ~bit(index);
  switch (served ? L1Cache::Result::kHit : l1_.access(line, index)) {
    case L1Cache::Result::kHit:
      stats_.l1_hits += 1;
      visited(slot, index);
      return Why::kVisiting;
    case L1Cache::Result::kMiss:
      stats_.l1_misses += 1;
      missing_ |= bit(index);
      return Why::kL1Miss;
    case L1Cache::Result::kFull:
      break;
  }
  stats_.l1_misses += 1;
  stats_.mshr_full += 1;
  no_mshr_ |= bit(index);
  return Why::kMshrFull;
}

void Trv::visited(Slot& slot, std::uint32_t index) {
  stats_.visits += 1;
  stats_.box_tests += 2;
  if (slot.restarting) {
    paths_[index].pop_back();
    slot.restarting = !paths_[index].empty();
    stats_.restarted_visits += 1;
  } else {
    const std::uint32_t step = *slot.next;
    slot.next += 1;
    const std::uint32_t hits = traces::hits_of(step);
    slot.must_pop = hits == 0;
    if (hits == 3) {
      stats_.pushes += 1;
      slot.stacked += 1;
      if (config_.stack == StackScheme::kRestartLink && slot.held == config_.stack_entries) {
        stats_.dropped += 1;
      } else {
        slot.held += 1;
      }
    }
  }
  pipes_.put(next_pipe(slot), index, visit_latency_);
}

void Trv::issue_pop() {
  if (popping_ == 0) return;
  const std::uint32_t index = pick(popping_, stack_turn_);
  stack_turn_ = (index + 1) % 64;
  popping_ &= ~bit(index);
  Slot& slot = slots_[index];
  if (slot.held == 0) {
    restart(slot, index);
  } else {
    stats_.pops += 1;
    slot.held -= 1;
    slot.stacked -= 1;
    if (slot.culls > 0) {
      slot.culls -= 1;
    } else {
      slot.must_pop = false;
    }
  }
  pipes_.put(next_pipe(slot), index, config_.stack_latency);
}

void Trv::restart(Slot& slot, std::uint32_t index) {
  assert(slot.stacked > 0 && "a pop from an empty stack");
  // From the link, which is the node of the oldest dropped entry, down to the node of the entry wanted now. Each visit
  // finds its far child again, so the short stack ends up holding the youngest entries.
  const std::vector<std::uint32_t> entries = pending_pushes(slot.begin, slot.next, slot.stacked);
  for (std::uint32_t node = entries.back();; node = tree_.parents[node]) {
    paths_[index].push_back(node);
    if (node == entries.front()) break;
  }
  slot.restarting = true;
  slot.held = static_cast<std::uint16_t>(std::min<std::uint32_t>(slot.stacked, config_.stack_entries));
  stats_.restarts += 1;
  stats_.pushes += slot.stacked;
  stats_.dropped += slot.stacked - slot.held;
}

void Trv::issue_leaf(sim::Time now) {
  if (leaving_ == 0 || now < leaf_free_at_ || !links_.leaves_out.can_push(now)) return;
  const std::uint32_t index = pick(leaving_, leaf_turn_);
  leaf_turn_ = (index + 1) % 64;
  leaving_ &= ~bit(index);
  Slot& slot = slots_[index];
  const std::uint32_t step = slot.next[0];
  const std::uint32_t count = traces::count_of(step);
  links_.leaves_out.push(now, LeafJob{traces::first_of(step), slot.next[1], static_cast<std::uint8_t>(count),
                                      static_cast<std::uint8_t>(index)});
  slot.next += 2;
  at_ist_ |= bit(index);
  leaf_free_at_ = clock_.after(now, std::max(count, 1U));
  stats_.leaves += 1;
}

void Trv::retire(sim::Time now) {
  if (retiring_ == 0 || !links_.rays_out.can_push(now)) return;
  const std::uint32_t index = pick(retiring_, retire_turn_);
  retire_turn_ = (index + 1) % 64;
  retiring_ &= ~bit(index);
  occupied_ &= ~bit(index);
  free_ |= bit(index);
  links_.rays_out.push(now, RayDone{slots_[index].id});
  stats_.rays_out += 1;
}

Trv::Why Trv::waiting() const {
  if (occupied_ == 0) return Why::kStarved;
  if (retiring_ != 0) return Why::kOutputFull;
  if (no_mshr_ != 0) return Why::kMshrFull;
  if (missing_ != 0) return Why::kL1Miss;
  if ((at_ist_ | leaving_) != 0) return Why::kIst;
  return Why::kPipe;
}

sim::Time Trv::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  if ((ready_ | popping_) != 0) return next;
  sim::Time at = pipes_.next();
  if (leaving_ != 0) at = std::min(at, std::max({next, leaf_free_at_, links_.leaves_out.push_at()}));
  if (retiring_ != 0) at = std::min(at, std::max(next, links_.rays_out.push_at()));
  if (free_ != 0) at = std::min(at, std::max(next, links_.rays_in.pop_at()));
  at = std::min(at, std::max(next, links_.leaves_in.pop_at()));
  at = std::min(at, std::max(next, links_.memory_in.pop_at()));
  return std::min(at, l1_.send_at(next, links_.memory_out));
}

std::string Trv::state() const {
  return fmt::format("rays {}: ready {}, stack {}, leaf {}, retiring {}, missing {}, no mshr {}, at ist {}",
                     std::popcount(occupied_), std::popcount(ready_), std::popcount(popping_), std::popcount(leaving_),
                     std::popcount(retiring_), std::popcount(missing_), std::popcount(no_mshr_),
                     std::popcount(at_ist_));
}

}  // namespace hw
