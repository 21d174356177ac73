#include <algorithm>
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
[[gnu::always_inline]] inline void Trv::put(FixedPipe& pipe, std::uint32_t index, Pipe to) {
  if (features<kDefault>().ideal) {
    next_cycle_[to] |= bit(index);
  } else {
    pipe.put(index, to, cycle_);
  }
}

template <bool kDefault>
[[gnu::always_inline]] inline void Trv::take_from_pipes(const Cycle& cycle) {
  const TrvFeatures has = features<kDefault>();
  const auto take = [&](FixedPipe& pipe) {
    const FixedPipe::Out out = pipe.take(cycle.number);
    waiting_[out.way] |= out.slots;
    if (has.prefetches && both_children_hit_ != 0 && (out.way == kToInner || out.way == kToLeaf))
      note_far_nodes(both_children_hit_ & out.slots);
  };
  take(box_);
  take(stack_);
  if (has.instances) take(transform_);
  if (has.ideal) {
    for (std::size_t way = 0; way < kPipes; ++way) waiting_[way] |= next_cycle_[way];
    if (has.prefetches && both_children_hit_ != 0)
      note_far_nodes(both_children_hit_ & (next_cycle_[kToInner] | next_cycle_[kToLeaf]));
    next_cycle_ = {};
  }
}

bool Trv::fill(sim::Time now) {
  if (arrivals_.lines > now) return false;
  fetch_.fill(links_.memory_in.pop(now).line, cycle_);
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

template <bool kDefault>
[[gnu::always_inline]] inline Trv::CycleReason Trv::issue_visit(std::uint32_t index) {
  Slot& slot = slots_[index];
  const TrvFeatures has = features<kDefault>();
  if (has.instances && enters_instance(slot, index)) return issue_transform(slot, index);
  const std::uint32_t node = slot.restarting ? paths_[index].back() : traces::node_of(slot.step);
  const TreeInMemory::Line read = has.plain ? TreeInMemory::Line{tree_.line_of(node), true}
                                            : tree_.line_of_visit(node, config_.box_testers, slot.child, slot.fetched);
  const FetchStage::Wait wait =
      has.reorders ? fetch_.read_reordered(index, read.line, cycle_) : fetch_.read(index, read.line, cycle_);
  if (wait == FetchStage::Wait::kNothing) {
    if (read.last) {
      visited<kDefault>(slot, index);
    } else {
      slot.fetched += 1;
      waiting_[kToInner] |= bit(index);
    }
    return CycleReason::kVisiting;
  }
  return missed(wait, index);
}

/// Counts the boxes of a pass. False if the visit needs another pass, which the slot now makes.
bool Trv::test_boxes(Slot& slot, std::uint32_t index) {
  slot.fetched = 0;
  (tree_.hybrid ? stats_.hybrid_box_tests : stats_.box_tests) += config_.box_testers;
  if (config_.box_testers == 2) return true;
  slot.child ^= 1U;
  if (slot.child == 0) return true;
  stats_.first_passes += 1;
  put<false>(box_, index, kToInner);
  return false;
}

template <bool kDefault>
[[gnu::always_inline]] inline void Trv::visited(Slot& slot, std::uint32_t index) {
  if (features<kDefault>().plain) {
    stats_.box_tests += 2;
  } else if (!test_boxes(slot, index)) {
    return;
  }
  stats_.visits += 1;
  if (slot.restarting) [[unlikely]] {
    visited_again(slot, index);
  } else if (step_on<kDefault>(slot) && features<kDefault>().prefetches) {
    both_children_hit_ |= bit(index);
  }
  put<kDefault>(box_, index, next_pipe(slot, features<kDefault>().instances));
}

/// Nearly as many rays hit both children as do not: without a branch.
template <bool kDefault>
inline bool Trv::step_on(Slot& slot) {
  const std::uint32_t hits = traces::hits_of(slot.step);
  slot.go(slot.next + 1);
  __builtin_prefetch(slot.next + 8);  // for the host: steps that the ray will take some visits from now
  slot.must_pop = hits == 0;
  const std::uint16_t both = hits == 3;
  slot.stack_depth += both;
  if (!features<kDefault>().stack) return both != 0;
  stats_.pushes += both;
  if (slot.short_stack_size != stack_room_) [[likely]] {
    slot.short_stack_size += both;
  } else {
    stats_.dropped += both;
  }
  return both != 0;
}

template <bool kDefault>
void Trv::pop(std::uint32_t index) {
  waiting_[kToStack] &= ~bit(index);
  Slot& slot = slots_[index];
  if (slot.short_stack_size == 0) {
    restart(slot, index);
  } else {
    stats_.pops += 1;
    slot.short_stack_size -= 1;
    take_entry(slot);
  }
  put<kDefault>(stack_, index, next_pipe(slot));
}

void Trv::take_entry(Slot& slot) {
  slot.stack_depth -= 1;
  if (slot.culls > 0) {
    slot.culls -= 1;
  } else {
    slot.must_pop = false;
  }
}

template <bool kDefault>
bool Trv::issue_pop() {
  if (waiting_[kToStack] == 0) return false;
  const std::uint32_t index = round_robin(waiting_[kToStack], stack_turn_);
  stack_turn_ = (index + 1) % 64;
  pop<kDefault>(index);
  return true;
}

bool Trv::issue_any(sim::Time now, CycleReason& why) {
  why = CycleReason::kSerial;
  if (now < leaf_free_at_) return true;
  const std::uint64_t work = shared_work(links_.leaves_out.can_push(now));
  if (work == 0) return false;
  const std::uint32_t index = next_of(work);
  if ((waiting_[kToStack] & bit(index)) != 0) {
    pop<false>(index);
  } else if ((waiting_[kToLeaf] & bit(index)) != 0) {
    send_leaf(now, index);
  } else {
    why = issue_visit<false>(index);
  }
  return true;
}

template <bool kDefault>
[[gnu::always_inline]] inline sim::Time Trv::tick_as(const Cycle& cycle) {
  const TrvFeatures has = features<kDefault>();
  const sim::Time now = cycle.now;
  const auto as_often_as_may_be = [&](auto&& step) {
    while (step() && has.ideal) {
    }
  };
  cycle_ = cycle.number;
  take_from_pipes<kDefault>(cycle);
  if (arrivals_.lines <= now) as_often_as_may_be([&] { return fill(now); });
  if (arrivals_.answers <= now) as_often_as_may_be([&] { return take_answer(now); });
  bool rays_moved = arrivals_.rays <= now && free_ != 0;
  if (rays_moved) as_often_as_may_be([&] { return take_ray(now); });
  bool tried = false;
  CycleReason why = CycleReason::kStarved;
  if (has.one_pipe) {
    tried = issue_any(now, why);
  } else {
    const std::uint64_t able = has.reorders ? waiting_[kToInner] : fetch_.able();
    tried = able != 0;
    if (tried) why = issue_visit<kDefault>(next_of(able));
    while (has.ideal && fetch_.able() != 0) {
      if (issue_visit<kDefault>(next_of(fetch_.able())) == CycleReason::kVisiting) why = CycleReason::kVisiting;
    }
    if (waiting_[kToStack] != 0) as_often_as_may_be([&] { return issue_pop<kDefault>(); });
    if (can_issue_leaf(now)) as_often_as_may_be([&] { return issue_leaf(now); });
  }
  if (waiting_[kToRetire] != 0) {
    rays_moved = true;
    as_often_as_may_be([&] { return retire(now); });
  }
  if (has.prefetches && !far_nodes_.empty()) prefetch_far_nodes();  // behind what rays need now
  fetch_.send(now, links_.memory_out);
  if (rays_moved) note_full(now);
  const bool go_on = !has.one_pipe && ((has.reorders ? waiting_[kToInner] : fetch_.able()) | waiting_[kToStack]) != 0;
  const sim::Time wake = go_on ? cycle.next : next_wake(cycle);
  const CycleReason then = tried && wake == cycle.next ? why : waiting(cycle.next);
  activity_.spend(now, clock_.period(), tried ? why : then, then);
  return wake;
}

template void Trv::put<false>(FixedPipe&, std::uint32_t, Pipe);

sim::Time Trv::tick_as_declared(const Cycle& cycle) { return tick_as<false>(cycle); }

sim::Time Trv::tick(sim::Time now) {
  const Cycle cycle(now, clock_);
  return is_default_ ? tick_as<true>(cycle) : tick_as_declared(cycle);
}

void Trv::tick_due(std::span<Trv* const> trvs, sim::Time* wakes, const Cycle& cycle) {
  if (trvs.front()->is_default_) {
    for (std::size_t t = 0; t < trvs.size(); ++t) {
      if (wakes[t] <= cycle.now) wakes[t] = trvs[t]->tick_as<true>(cycle);
    }
  } else {
    for (std::size_t t = 0; t < trvs.size(); ++t) {
      if (wakes[t] <= cycle.now) wakes[t] = trvs[t]->tick_as_declared(cycle);
    }
  }
}

}  // namespace hw
