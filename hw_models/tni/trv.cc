#include "hw_models/tni/trv.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

Trv::Trv(const TrvConfig& config, const TniMode& mode, const TreeInMemory& tree, Links links, std::uint16_t port,
         sim::Clock clock)
    : box_latency_(config.l1.hit_cycles + config.box_latency),
      transform_latency_(config.l1.hit_cycles + config.transform_latency),
      stack_latency_(config.stack_latency),
      stack_room_(config.stack == StackScheme::kFull ? ~std::uint32_t{0} : config.stack_entries),
      features_{.instances = !tree.placed.empty(),
                .plain = tree.node_is_line() && !tree.hybrid && config.box_testers == 2,
                .one_pipe = config.box_testers == 1 && !mode.ideal,
                .ideal = mode.ideal,
                .prefetches = config.prefetch == Prefetch::kSibling,
                .reorders = mode.handling == MissHandling::kReorder && !mode.ideal_l1,
                .stack = stack_room_ != 0},
      is_default_(features_ == kDefaultTrvFeatures),
      slots_(config.rays),
      clock_(clock),
      fetch_(config.l1, mode, port, waiting_[kToInner]),
      pipes_(clock, std::max({box_latency_, transform_latency_, stack_latency_})),
      tree_(tree),
      links_(links),
      free_(all_slots(config.rays)),
      config_(config),
      begins_(config.rays),
      paths_(config.rays) {
  links_.rays_in.shows(&arrivals_.rays, &arrivals_.soonest);
  links_.leaves_in.shows(&arrivals_.answers, &arrivals_.soonest);
  links_.memory_in.shows(&arrivals_.lines, &arrivals_.soonest);
  far_nodes_.reserve(config.rays);
  for (auto& path : paths_) path.reserve(kMostDepth);
  pushed_.reserve(kMostDepth);
}

Trv::Stats Trv::stats() const {
  Stats all = stats_;
  static_cast<FetchStats&>(all) = fetch_.stats();
  (tree_.hybrid ? all.hybrid_box_tests : all.box_tests) = (all.visits + all.first_passes) * config_.box_testers;
  return all;
}

void Trv::finish(sim::Time end) {
  activity_.finish(end);
  if (full_ && end > full_since_) {
    full_time_ += end - full_since_;
    full_since_ = end;
    stats_.full_visits += stats_.visits - full_since_visit_;
    full_since_visit_ = stats_.visits;
  }
  stats_.full = clock_.cycles(full_time_);
}

/// Rays have come or gone in the cycle at `now`, which counts as what it is at its end; its visit as the cycle before.
void Trv::note_full(sim::Time now) {
  rays_moved_ = false;
  if (full_ == (free_ == 0)) return;
  full_ = !full_;
  if (full_) {
    full_since_ = now;
    full_since_visit_ = stats_.visits;
  } else {
    full_time_ += now - full_since_;
    stats_.full_visits += stats_.visits - full_since_visit_;
  }
}

void Trv::note_far_nodes(std::uint64_t visited) {
  both_children_hit_ &= ~visited;
  for (; visited != 0; visited &= visited - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(visited));
    const std::uint32_t step = slots_[slot].next[-1];
    const std::uint32_t far = tree_.links[traces::node_of(step)].child[1 - traces::near_of(step)];
    if (!traces::is_leaf(far)) far_nodes_.push_back({far, slot});
  }
}

void Trv::prefetch_far_nodes(std::uint64_t cycle) {
  for (const auto [node, slot] : far_nodes_) {
    if (!fetch_.can_prefetch()) break;
    stats_.prefetch_probes += 1;
    const Addr line = tree_.line_of_visit(node, config_.box_testers, 0, 0).line;
    if (fetch_.prefetch(line, slot, cycle)) stats_.prefetches += 1;
  }
  far_nodes_.clear();
}

/// The line was not there.
Trv::CycleReason Trv::missed(FetchStage::Wait wait, std::uint32_t index, std::uint64_t cycle) {
  if (fetch_.bypasses()) {
    stats_.bypass_passes += 1;
    pipes_.put(kToInner, index, cycle, box_latency_);
  }
  return FetchStage::reason(wait, CycleReason::kL1Miss);
}

/// Slots that may enter the one pipe; those with leaves only if there is room for a leaf.
std::uint64_t Trv::shared_work(bool room_for_leaves) const {
  if (fetch_.stands()) return fetch_.able();
  return fetch_.able() | waiting_[kToStack] | (room_for_leaves ? waiting_[kToLeaf] : 0);
}

Trv::CycleReason Trv::waiting(sim::Time next) const {
  if (occupied_ == 0) return CycleReason::kStarved;
  if (features_.one_pipe && next < leaf_free_at_) return CycleReason::kSerial;
  if (waiting_[kToRetire] != 0) return CycleReason::kOutputFull;
  return FetchStage::reason(fetch_.waits_for(),
                            (at_ist_ | waiting_[kToLeaf]) != 0 ? CycleReason::kIst : CycleReason::kPipe);
}

sim::Time Trv::next_wake(const Cycle& cycle) const {
  const sim::Time next = cycle.next;
  sim::Time at = pipes_.next(cycle);
  if (features_.one_pipe) {
    const sim::Time free_at = std::max(next, leaf_free_at_);
    if (free_at > next || shared_work(false) != 0) at = std::min(at, free_at);
    if (waiting_[kToLeaf] != 0 && !fetch_.stands()) at = std::min(at, std::max(free_at, links_.leaves_out.push_at()));
  } else if (waiting_[kToLeaf] != 0) {
    at = std::min(at, std::max({next, leaf_free_at_, links_.leaves_out.push_at()}));
  }
  if (waiting_[kToRetire] != 0) at = std::min(at, std::max(next, links_.rays_out.push_at()));
  at = std::min(at, std::max(next, arrivals_.soonest));
  return std::min(at, fetch_.send_at(next, links_.memory_out));
}

std::string Trv::state() const {
  return fmt::format("rays {}: ready {}, stack {}, leaf {}, retiring {}, missing {}, no mshr {}, at ist {}",
                     std::popcount(occupied_), std::popcount(waiting_[kToInner]), std::popcount(waiting_[kToStack]),
                     std::popcount(waiting_[kToLeaf]), std::popcount(waiting_[kToRetire]),
                     std::popcount(fetch_.missing()), std::popcount(fetch_.no_mshr()), std::popcount(at_ist_));
}

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

bool Trv::enters_instance(const Slot& slot, std::uint32_t index) const {
  return slot.restarting ? (paths_[index].back() & kEnter) != 0 : traces::is_enter(slot.step);
}

/// One operation of the box pipe: 9 multiplications and as many additions for the origin, 9 and 6 for the direction,
/// and its reciprocal.
Trv::CycleReason Trv::issue_transform(Slot& slot, std::uint32_t index, std::uint64_t cycle) {
  const std::uint32_t instance = slot.restarting ? paths_[index].back() & ~kEnter : traces::instance_of(slot.step);
  const FetchStage::Wait wait = fetch_.read(index, tree_.line_of_instance(instance), cycle);
  if (wait != FetchStage::Wait::kNothing) return missed(wait, index, cycle);
  stats_.transforms += 1;
  if (slot.restarting) {
    paths_[index].pop_back();  // never the last: the way goes on to a node of the instance's tree
  } else {
    slot.go(slot.next + 1);
  }
  pipes_.put(kToInner, index, cycle, transform_latency_);
  return CycleReason::kVisiting;
}

bool Trv::issue_leaf(sim::Time now) {
  const std::uint64_t leaves = free_leaves(now);
  if (leaves == 0) return false;
  const std::uint32_t index = round_robin(leaves, leaf_turn_);
  leaf_turn_ = (index + 1) % 64;
  send_leaf(now, index);
  return true;
}

void Trv::send_leaf(sim::Time now, std::uint32_t index) {
  waiting_[kToLeaf] &= ~bit(index);
  Slot& slot = slots_[index];
  const std::uint32_t step = slot.step;
  const std::uint32_t count = traces::count_of(step);
  links_.leaves_out.push(now, LeafJob{traces::first_of(step), slot.next[1], static_cast<std::uint8_t>(count),
                                      static_cast<std::uint8_t>(index), fetch_.owner(index)});
  slot.go(slot.next + 2);
  at_ist_ |= bit(index);
  if (!features_.ideal) leaf_free_at_ = clock_.after(now, std::max(count, 1U));
  stats_.leaves += 1;
}

void Trv::put_out(const Cycle& cycle) {
  if (!features_.one_pipe) as_often_as_may_be(features_.ideal, [&] { return issue_leaf(cycle.now); });
  if (waiting_[kToRetire] != 0) {
    as_often_as_may_be(features_.ideal, [&] { return retire(cycle.now); });
    if (free_ != 0) arrivals_.soonest = std::min(arrivals_.soonest, arrivals_.rays);
    rays_moved_ = true;
  }
  if (!far_nodes_.empty()) prefetch_far_nodes(cycle.number);  // behind what rays need now
  fetch_.send(cycle.now, links_.memory_out);
}

bool Trv::retire(sim::Time now) {
  if (waiting_[kToRetire] == 0 || !links_.rays_out.can_push(now)) return false;
  const std::uint32_t index = round_robin(waiting_[kToRetire], retire_turn_);
  retire_turn_ = (index + 1) % 64;
  waiting_[kToRetire] &= ~bit(index);
  occupied_ &= ~bit(index);
  free_ |= bit(index);
  links_.rays_out.push(now, RayDone{slots_[index].id, fetch_.owner(index)});
  stats_.rays_out += 1;
  return true;
}

using traces::StepKind;

/// Where the entries now on a ray's stack were pushed, oldest first, found by following its walk up to its next step.
/// Restarts are rare; keeping such a list for every ray is not worth the memory.
void Trv::find_pushes(const Slot& slot, std::uint32_t index) {
  pushed_.clear();
  std::uint32_t instance = traces::kNone;
  bool must_pop = false;
  for (const std::uint32_t* step = begins_[index]; step != slot.next; ++step) {
    const StepKind kind = traces::kind_of(*step);
    if (kind == StepKind::kCull) {
      // The culls just before `next` are under way: `stack_depth` says how far.
      if (step + 1 != slot.next) pushed_.resize(pushed_.size() - traces::culled_of(*step));
      continue;
    }
    if (must_pop) {
      instance = pushed_.back().instance;  // the ray goes on in the instance of the entry
      pushed_.pop_back();
    }
    if (traces::is_enter(*step)) {
      instance = traces::instance_of(*step);
      must_pop = false;
      continue;
    }
    must_pop = kind == StepKind::kLeaf || traces::hits_of(*step) == 0;
    if (kind == StepKind::kLeaf) {
      ++step;  // its exit phases
    } else if (traces::hits_of(*step) == 3) {
      pushed_.push_back({traces::node_of(*step), instance});
    }
  }
  pushed_.resize(slot.stack_depth);
}

void Trv::restart(Slot& slot, std::uint32_t index) {
  assert(slot.stack_depth > 0 && "a pop from an empty stack");
  // From the link, which is the node of the oldest dropped entry, or from the root, down to the node of the entry
  // wanted now. Each visit finds its far child again, so the short stack ends up holding the youngest entries; the
  // trail says that the last one is where to go on, without a pop.
  find_pushes(slot, index);
  const bool trail = config_.stack == StackScheme::kRestartTrail;
  const std::uint32_t from = trail ? 0 : pushed_.front().node;
  const std::uint32_t instance = pushed_.back().instance;
  const std::uint32_t root = instance == traces::kNone ? traces::kNone : tree_.placed[instance].root;
  // From the tree of an instance, unless all of the way is in it, up into the one over instances.
  for (std::uint32_t node = pushed_.back().node;;) {
    paths_[index].push_back(node);
    if (node == from) break;
    if (node == root) {
      paths_[index].push_back(kEnter | instance);
      node = tree_.parents[tree_.links.size() + instance];
    } else {
      node = tree_.parents[node];
    }
  }
  slot.restarting = true;
  stats_.restarts += 1;
  const std::uint32_t found = slot.stack_depth - (trail ? 1U : 0U);
  slot.short_stack_size = static_cast<std::uint16_t>(std::min(found, config_.stack_entries));
  if (config_.stack_entries == 0) return;
  stats_.pushes += found;
  stats_.dropped += found - slot.short_stack_size;
}

void Trv::visited_again(Slot& slot, std::uint32_t index) {
  stats_.restarted_visits += 1;
  paths_[index].pop_back();
  slot.restarting = !paths_[index].empty();
  if (!slot.restarting && config_.stack == StackScheme::kRestartTrail) take_entry(slot);
}

}  // namespace hw
