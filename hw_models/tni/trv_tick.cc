#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "hw_models/tni/trv.h"
#include "traces/walk.h"

namespace hw {

using traces::StepKind;

/// next_pipe() for the rare steps that the table of kinds does not cover.
Trv::Pipe Trv::next_pipe_of_few(Slot& slot) {
  if (slot.restarting) return kToInner;
  if (traces::kind_of(slot.step) == StepKind::kCull) {
    slot.culls = traces::culled_of(slot.step);
    slot.go(slot.next + 1);
  }
  if (slot.culls > 0) return kToStack;
  return next_pipe(slot);
}

[[gnu::always_inline]] inline Trv::Pipe Trv::next_pipe(Slot& slot, bool instances) {
  // Indexed by kind of step; the second half is for steps behind a pop.
  static constexpr std::array<Pipe, 8> kPipeOf{kToInner, kToLeaf,  kToStack, kToRetire,
                                               kToStack, kToStack, kToStack, kToRetire};
  const StepKind kind = traces::kind_of(slot.step);
  if (slot.restarting || slot.culls > 0 || kind == StepKind::kCull) [[unlikely]]
    return next_pipe_of_few(slot);
  if (instances && !slot.must_pop && traces::is_enter(slot.step)) [[unlikely]]
    return kToInner;
  return kPipeOf[static_cast<std::size_t>(kind) + (slot.must_pop ? 4U : 0U)];
}

template <bool kDefault>
[[gnu::always_inline]] inline void Trv::take_from_pipes(const Cycle& cycle) {
  if (!features<kDefault>().prefetches || both_children_hit_ == 0) {
    pipes_.take(cycle.number, waiting_);
    return;
  }
  TimingWheel<kPipes>::Masks out{};
  pipes_.take(cycle.number, out);
  for (std::size_t way = 0; way < kPipes; ++way) waiting_[way] |= out[way];
  note_far_nodes(both_children_hit_ & (out[kToInner] | out[kToLeaf]));
}

bool Trv::fill(const Cycle& cycle) {
  if (arrivals_.lines > cycle.now) return false;
  fetch_.fill(links_.memory_in.pop(cycle.now).line, cycle.number);
  return true;
}

bool Trv::take_answer(sim::Time now) {
  if (arrivals_.answers > now) return false;
  const std::uint32_t index = links_.leaves_in.pop(now).slot;
  at_ist_ &= ~bit(index);
  Slot& slot = slots_[index];
  slot.must_pop = true;
  switch (next_pipe(slot)) {
    case kToStack:
      waiting_[kToStack] |= bit(index);
      break;
    case kToRetire:
      waiting_[kToRetire] |= bit(index);
      break;
    default:
      assert(false && "a leaf is followed by a pop or the end");
  }
  return true;
}

bool Trv::take_ray(sim::Time now) {
  if (free_ == 0 || arrivals_.rays > now) return false;
  const RayJob job = links_.rays_in.pop(now);
  const auto index = static_cast<std::uint32_t>(std::countr_zero(free_));
  free_ &= ~bit(index);
  occupied_ |= bit(index);
  Slot& slot = slots_[index];
  slot = Slot{};
  slot.id = job.id;
  slot.go(job.walk);
  begins_[index] = job.walk;
  fetch_.belongs(index, job.owner);
  stats_.rays_in += 1;
  switch (next_pipe(slot)) {
    case kToInner:
      waiting_[kToInner] |= bit(index);
      break;
    case kToRetire:
      waiting_[kToRetire] |= bit(index);
      break;
    default:
      assert(false && "a walk begins with the root");
  }
  return true;
}

void Trv::take_arrivals(const Cycle& cycle) {
  as_often_as_may_be(features_.ideal, [&] { return fill(cycle); });
  as_often_as_may_be(features_.ideal, [&] { return take_answer(cycle.now); });
  rays_moved_ = arrivals_.rays <= cycle.now && free_ != 0;
  as_often_as_may_be(features_.ideal, [&] { return take_ray(cycle.now); });
  arrivals_.soonest = std::min({arrivals_.lines, arrivals_.answers, free_ != 0 ? arrivals_.rays : sim::kNever});
}

template <bool kDefault>
[[gnu::always_inline]] inline Trv::CycleReason Trv::issue_visit(std::uint32_t index, const Cycle& cycle) {
  Slot& slot = slots_[index];
  const TrvFeatures has = features<kDefault>();
  if (has.instances && enters_instance(slot, index)) return issue_transform(slot, index, cycle.number);
  const std::uint32_t node = slot.restarting ? paths_[index].back() : traces::node_of(slot.step);
  const TreeInMemory::Line read = has.plain ? TreeInMemory::Line{tree_.line_of(node), true}
                                            : tree_.line_of_visit(node, config_.box_testers, slot.child, slot.fetched);
  if (has.reorders && fetch_.reads_at_once(bit(index), read.line)) {
    waiting_[kToInner] &= ~bit(index);
  } else if (const FetchStage::Wait wait = fetch_.read(index, read.line, cycle.number);
             wait != FetchStage::Wait::kNothing) {
    return missed(wait, index, cycle.number);
  }
  if (read.last) {
    visited<kDefault>(slot, index, cycle.number);
  } else {
    slot.fetched += 1;
    waiting_[kToInner] |= bit(index);
  }
  return CycleReason::kVisiting;
}

bool Trv::ends_with_pass(Slot& slot, std::uint32_t index, std::uint64_t cycle) {
  slot.fetched = 0;
  if (config_.box_testers == 2) return true;
  slot.child ^= 1U;
  if (slot.child == 0) return true;
  stats_.first_passes += 1;
  pipes_.put(kToInner, index, cycle, box_latency_);
  return false;
}

template <bool kDefault>
[[gnu::always_inline]] inline void Trv::visited(Slot& slot, std::uint32_t index, std::uint64_t cycle) {
  if (!features<kDefault>().plain && !ends_with_pass(slot, index, cycle)) return;
  stats_.visits += 1;
  if (slot.restarting) [[unlikely]] {
    visited_again(slot, index);
  } else if (step_on<kDefault>(slot) && features<kDefault>().prefetches) {
    both_children_hit_ |= bit(index);
  }
  pipes_.put(next_pipe(slot, features<kDefault>().instances), index, cycle, box_latency_);
}

/// Nearly as many rays hit both children as do not: without a branch.
template <bool kDefault>
inline bool Trv::step_on(Slot& slot) {
  const std::uint32_t hits = traces::hits_of(slot.step);
  slot.go(slot.next + 1);
  __builtin_prefetch(slot.next + 8);  // for the host: steps that the ray will take some visits from now
  slot.must_pop = hits == 0;
  const unsigned both = hits == 3;
  slot.stack_depth = static_cast<std::uint16_t>(slot.stack_depth + both);
  if (!features<kDefault>().stack) return both != 0;
  stats_.pushes += both;
  if (slot.short_stack_size != stack_room_) [[likely]] {
    slot.short_stack_size = static_cast<std::uint16_t>(slot.short_stack_size + both);
  } else {
    stats_.dropped += both;
  }
  return both != 0;
}

[[gnu::always_inline]] inline void Trv::pop(std::uint32_t index, std::uint64_t cycle) {
  waiting_[kToStack] &= ~bit(index);
  Slot& slot = slots_[index];
  if (slot.short_stack_size == 0) {
    restart(slot, index);
  } else {
    stats_.pops += 1;
    slot.short_stack_size -= 1;
    take_entry(slot);
  }
  pipes_.put(next_pipe(slot), index, cycle, stack_latency_);
}

void Trv::take_entry(Slot& slot) {
  slot.stack_depth -= 1;
  if (slot.culls > 0) {
    slot.culls -= 1;
  } else {
    slot.must_pop = false;
  }
}

[[gnu::always_inline]] inline void Trv::issue_pop(const Cycle& cycle) {
  const std::uint32_t index = round_robin(waiting_[kToStack], stack_turn_);
  stack_turn_ = (index + 1) % 64;
  pop(index, cycle.number);
}

Trv::CycleReason Trv::issue_any(const Cycle& cycle) {
  if (cycle.now < leaf_free_at_) return CycleReason::kSerial;
  const std::uint64_t work = shared_work(links_.leaves_out.can_push(cycle.now));
  if (work == 0) return CycleReason::kStarved;
  const std::uint32_t index = next_of(work);
  if ((waiting_[kToStack] & bit(index)) != 0) {
    pop(index, cycle.number);
  } else if ((waiting_[kToLeaf] & bit(index)) != 0) {
    send_leaf(cycle.now, index);
  } else {
    return issue_visit<false>(index, cycle);
  }
  return CycleReason::kSerial;
}

template <bool kDefault>
[[gnu::always_inline]] inline sim::Time Trv::tick_as(const Cycle& cycle) {
  const TrvFeatures has = features<kDefault>();
  const sim::Time now = cycle.now;
  const auto able = [&] { return has.reorders ? waiting_[kToInner] : fetch_.able(); };
  take_from_pipes<kDefault>(cycle);
  if (arrivals_.soonest <= now) take_arrivals(cycle);
  CycleReason why = CycleReason::kStarved;  // nothing is tried
  if (has.one_pipe) {
    why = issue_any(cycle);
  } else {
    if (able() != 0) why = issue_visit<kDefault>(next_of(able()), cycle);
    while (has.ideal && able() != 0) {
      if (issue_visit<kDefault>(next_of(able()), cycle) == CycleReason::kVisiting) why = CycleReason::kVisiting;
    }
    if (waiting_[kToStack] != 0) issue_pop(cycle);
    while (has.ideal && waiting_[kToStack] != 0) issue_pop(cycle);
  }
  if (has_output(now) || (has.prefetches && !far_nodes_.empty())) put_out(cycle);
  if (rays_moved_) note_full(now);
  const bool go_on = !has.one_pipe && (able() | waiting_[kToStack] | pipes_.comes_out(cycle.number + 1)) != 0;
  const sim::Time wake = go_on ? cycle.next : next_wake(cycle);
  const bool tried = why != CycleReason::kStarved;
  const CycleReason then = tried && wake == cycle.next ? why : waiting(cycle.next);
  activity_.spend(now, clock_.period(), tried ? why : then, then);
  return wake;
}

sim::Time Trv::tick_as_declared(const Cycle& cycle) { return tick_as<false>(cycle); }

sim::Time Trv::tick(sim::Time now) {
  const Cycle cycle(now, clock_);
  return is_default_ ? tick_as<true>(cycle) : tick_as_declared(cycle);
}

void Trv::tick_due(std::span<Trv* const> trvs, std::uint64_t due, sim::Time* wakes, const Cycle& cycle) {
  const bool is_default = trvs.front()->is_default_;
  for (; due != 0; due &= due - 1) {
    const auto t = static_cast<std::size_t>(std::countr_zero(due));
    wakes[t] = is_default ? trvs[t]->tick_as<true>(cycle) : trvs[t]->tick_as_declared(cycle);
  }
}

}  // namespace hw
