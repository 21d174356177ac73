#include "hw_models/tni/trv.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <utility>

#include <fmt/format.h>

#include "traces/walk.h"

namespace hw {

static constexpr std::size_t kUsualStackDepth = 128;  ///< stack entries for which memory is reserved
static constexpr Addr kNoLine = ~Addr{0};             ///< from this address down: no line of memory

Trv::Trv(const TrvConfig& config, const TniMode& mode, const TreeInMemory& tree,
         std::shared_ptr<const Treelets> treelets, Links links, std::uint16_t client, sim::Clock clock)
    : box_latency_(config.l1.hit_cycles + config.visit_latency(tree.kind)),
      transform_latency_(config.l1.hit_cycles + config.transform_latency),
      stack_latency_(config.stack_latency),
      stack_{config.stack, config.stack == StackScheme::kFull ? ~std::uint32_t{0} : config.stack_entries},
      features_{.instances = !tree.placed.empty(),
                .plain = !tree.kind.wide && tree.has_one_line_per_node() && !tree.hybrid && config.box_testers >= 2 &&
                         config.stack != StackScheme::kParent,
                .one_pipe = config.box_testers == 1 && !mode.ideal,
                .ideal = mode.ideal,
                .prefetches = config.prefetch == Prefetch::kSibling,
                .prefetcher = config.has_prefetch_queue(),
                .gathers = config.gather != Gather::kOff,
                .reorders = mode.handling == MissHandling::kReorder && !mode.ideal_l1,
                .stack = stack_.capacity != 0,
                .wide = tree.kind.wide,
                .node_stack = tree.kind.wide && config.stack_push == StackPush::kNode},
      code_(features_ == kDefaultTrvFeatures ? TrvCode::kDefault
            : features_ == kWideTrvFeatures  ? TrvCode::kWide
                                             : TrvCode::kAny),
      slots_(config.rays),
      clock_(clock),
      fetch_(config.l1, mode, client, waiting_[kToInner]),
      pipes_(clock, std::max({box_latency_ + config.most_passes(tree.kind) - 1, transform_latency_, stack_latency_})),
      tree_(tree),
      links_(links),
      free_(first_slots_mask(config.rays)),
      config_(config),
      reads_parent_links_(config.stack == StackScheme::kParent && !tree.parents_in_nodes),
      reads_early_lines_(reads_parent_links_ || tree.wide_nodes_have_lines),
      wide_records_(tree.wide ? tree.wide->data() : nullptr),
      begins_(config.rays),
      paths_(config.rays) {
  for (std::uint32_t children = 0; children < passes_.size(); ++children) {
    const std::uint32_t passes = std::max(1U, (children + config.box_testers - 1) / config.box_testers);
    passes_[children] = static_cast<std::uint8_t>(passes);
    comparisons_[children] = static_cast<std::uint8_t>(tree.kind.comparisons(children));
  }
  if (features_.node_stack) {
    node_stacks_.resize(config.rays);
    extra_links_.resize(config.rays);
  }
  links_.rays_in.store_pop_time_in(&arrivals_.rays, &arrivals_.soonest);
  links_.leaves_in.store_pop_time_in(&arrivals_.answers, &arrivals_.soonest);
  links_.memory_in.store_pop_time_in(&arrivals_.lines, &arrivals_.soonest);
  if (features_.prefetcher) {
    prefetcher_.emplace(config, tree_, std::move(treelets), links_.leaf_prefetches_out);
    fetch_.count_prefetches();
  }
  stats_.has_prefetcher = features_.prefetcher;
  stats_.gathers = features_.gathers;
  far_nodes_.reserve(config.rays);
  entries_.reserve(kUsualStackDepth);
}

Trv::Stats Trv::stats() const {
  Stats all = stats_;
  static_cast<FetchStats&>(all) = fetch_.stats();
  if (prefetcher_) {
    all.prefetch_stack_reads = prefetcher_->stats().stack_reads;
    all.prefetch_probes = prefetcher_->stats().probes;
    all.prefetches = prefetcher_->stats().requests;
    all.prefetches_dropped = prefetcher_->stats().dropped;
    all.prefetched_leaves = prefetcher_->stats().leaves;
    all.map_reads = prefetcher_->stats().map_reads;
    all.map_misses = prefetcher_->stats().map_misses;
    all.map_fills = prefetcher_->stats().map_fills;
    all.prefetches_useful = fetch_.prefetch_counts().useful;
    all.prefetches_late = fetch_.prefetch_counts().late;
    all.prefetches_useless = fetch_.prefetch_counts().useless;
  }
  if (features_.wide) {
    (tree_.kind.format == traces::NodeFormat::kQ12      ? all.q12_box_tests
     : tree_.kind.is_decoded()                          ? all.q8_box_tests
     : tree_.kind.format == traces::NodeFormat::kHybrid ? all.hybrid_box_tests
                                                        : all.box_tests) = all.children;
    all.idle_lanes = all.box_cycles * config_.box_testers - all.children;
    if (tree_.kind.is_decoded()) all.decoded_nodes = all.visits;
  } else {
    const std::uint64_t passes = all.visits + all.first_passes;
    const std::uint64_t tests = passes * std::min(config_.box_testers, 2U);
    (tree_.hybrid ? all.hybrid_box_tests : all.box_tests) = tests;
    all.idle_lanes = passes * config_.box_testers - tests;
  }
  if (config_.idle_testers == IdleTesters::kClocked) all.clocked_lanes = all.idle_lanes;
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

/// Updates the counts of cycles and node visits with a full input buffer. Called after rays have entered or left at
/// time `now`. A cycle counts if the buffer is full at its end, a visit if it was full before the visit's cycle.
void Trv::account_full_buffer(sim::Time now) {
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

void Trv::collect_far_nodes(std::uint64_t visited_slots) {
  both_children_hit_ &= ~visited_slots;
  for (; visited_slots != 0; visited_slots &= visited_slots - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(visited_slots));
    const std::uint32_t step = slots_[slot].last_visit();
    if (features_.wide) {
      const std::uint32_t node = traces::node_of(slots_[slot].last_wide_visit());
      const std::uint32_t next = tree_.wide_links[node].child[traces::hit_slot_of(step, 1)];
      if (!traces::is_leaf(next)) far_nodes_.push_back({next, slot});
      continue;
    }
    const std::uint32_t far = tree_.links[traces::node_of(step)].child[1 - traces::near_of(step)];
    if (!traces::is_leaf(far)) far_nodes_.push_back({far, slot});
  }
}

void Trv::prefetch_far_nodes(std::uint64_t cycle) {
  for (const auto [node, slot] : far_nodes_) {
    if (!fetch_.can_prefetch()) break;
    stats_.prefetch_probes += 1;
    const Addr line = features_.wide ? tree_.line_of_wide_visit((*tree_.wide)[node], 0).line
                                     : tree_.line_of_visit(node, config_.box_testers, 0, 0).line;
    if (fetch_.prefetch_line(line, fetch_.slot_tile(slot), cycle)) stats_.prefetches += 1;
  }
  far_nodes_.clear();
}

/// Handles a TRV slot's miss in the L1. Returns the reason to which the cycle is charged.
Trv::CycleReason Trv::handle_miss(FetchStage::Wait wait, std::uint32_t index, std::uint64_t cycle) {
  if (fetch_.is_bypassing()) {
    stats_.bypass_passes += 1;
    pipes_.schedule_completion(kToInner, index, cycle, box_latency_);
  }
  return FetchStage::wait_reason(wait, CycleReason::kL1Miss);
}

/// Returns a mask of the slots that may enter the shared pipe of a TRV. Slots with a leaf are included only if
/// `room_for_leaves`.
std::uint64_t Trv::shared_pipe_slots(bool room_for_leaves) const {
  if (fetch_.is_stalled()) return fetch_.issuable_slot_mask();
  return fetch_.issuable_slot_mask() | waiting_[kToStack] | (room_for_leaves ? waiting_[kToLeaf] : 0);
}

Trv::CycleReason Trv::wait_reason(sim::Time next) const {
  if (occupied_ == 0) return CycleReason::kStarved;
  if (features_.one_pipe && next < leaf_free_at_) return CycleReason::kSerial;
  if (waiting_[kToRetire] != 0) return CycleReason::kOutputFull;
  return FetchStage::wait_reason(fetch_.scarcest_wait(),
                                 (at_ist_ | waiting_[kToLeaf]) != 0 ? CycleReason::kIst : CycleReason::kPipe);
}

sim::Time Trv::next_wake(const Cycle& cycle) const {
  const sim::Time next = cycle.next;
  sim::Time at = pipes_.next_completion(cycle);
  if (features_.one_pipe) {
    const sim::Time free_at = std::max(next, leaf_free_at_);
    if (free_at > next || shared_pipe_slots(false) != 0) at = std::min(at, free_at);
    if (waiting_[kToLeaf] != 0 && !fetch_.is_stalled())
      at = std::min(at, std::max(free_at, links_.leaves_out.push_at()));
  } else if (waiting_[kToLeaf] != 0) {
    at = std::min(at, std::max({next, leaf_free_at_, links_.leaves_out.push_at()}));
  }
  if (waiting_[kToRetire] != 0) at = std::min(at, std::max(next, links_.rays_out.push_at()));
  if (prefetcher_) at = std::min(at, prefetcher_->next_wake(fetch_, next));
  at = std::min(at, std::max(next, arrivals_.soonest));
  return std::min(at, fetch_.next_send_time(next, links_.memory_out));
}

std::string Trv::state() const {
  return fmt::format("rays {}: ready {}, stack {}, leaf {}, retiring {}, missing {}, no mshr {}, at ist {}",
                     std::popcount(occupied_), std::popcount(waiting_[kToInner]), std::popcount(waiting_[kToStack]),
                     std::popcount(waiting_[kToLeaf]), std::popcount(waiting_[kToRetire]),
                     std::popcount(fetch_.missing_slots()), std::popcount(fetch_.slots_without_mshr()),
                     std::popcount(at_ist_));
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::take_from_pipes(const Cycle& cycle) {
  if (!active_features<kCode>().prefetches || both_children_hit_ == 0) {
    pipes_.take_completed(cycle.number, waiting_);
    return;
  }
  TimingWheel<kPipes>::Masks out{};
  pipes_.take_completed(cycle.number, out);
  for (std::size_t pipe = 0; pipe < kPipes; ++pipe) waiting_[pipe] |= out[pipe];
  collect_far_nodes(both_children_hit_ & (out[kToInner] | out[kToLeaf]));
}

bool Trv::fill_arrived_line(const Cycle& cycle) {
  if (arrivals_.lines > cycle.now) return false;
  const Addr line = links_.memory_in.pop(cycle.now).line;
  fetch_.fill_line(line, cycle.number);
  if (prefetcher_) prefetcher_->fill_line(line);
  return true;
}

bool Trv::take_answer(sim::Time now) {
  if (arrivals_.answers > now) return false;
  const std::uint32_t index = links_.leaves_in.pop(now).slot;
  at_ist_ &= ~slot_bit(index);
  TraversalSlot& slot = slots_[index];
  slot.take_answer();
  switch (slot.next_pipe()) {
    case kToStack:
      waiting_[kToStack] |= slot_bit(index);
      break;
    case kToRetire:
      waiting_[kToRetire] |= slot_bit(index);
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
  free_ &= ~slot_bit(index);
  occupied_ |= slot_bit(index);
  TraversalSlot& slot = slots_[index];
  slot = TraversalSlot(job.walk, job.id);
  if (features_.node_stack) node_stacks_[index].begin_at(traces::node_of(*job.walk));
  if (prefetcher_) prefetcher_->begin_ray(index);
  begins_[index] = job.walk;
  fetch_.set_slot_tile(index, job.tile);
  stats_.rays_in += 1;
  switch (slot.next_pipe()) {
    case kToInner:
      waiting_[kToInner] |= slot_bit(index);
      break;
    case kToRetire:
      waiting_[kToRetire] |= slot_bit(index);
      break;
    default:
      assert(false && "a walk begins with the root");
  }
  return true;
}

void Trv::take_arrivals(const Cycle& cycle) {
  run_once_or_drain(features_.ideal, [&] { return fill_arrived_line(cycle); });
  run_once_or_drain(features_.ideal, [&] { return take_answer(cycle.now); });
  rays_moved_ = arrivals_.rays <= cycle.now && free_ != 0;
  run_once_or_drain(features_.ideal, [&] { return take_ray(cycle.now); });
  arrivals_.soonest = std::min({arrivals_.lines, arrivals_.answers, free_ != 0 ? arrivals_.rays : sim::kNever});
}

template <TrvCode kCode>
[[gnu::always_inline]] inline Trv::VisitLine Trv::next_line(const TraversalSlot& slot, std::uint32_t index) const {
  const TrvFeatures has = active_features<kCode>();
  VisitLine line;
  const bool repeated = slot.is_restarting();
  line.node = repeated                            ? paths_[index].next_node()
              : has.node_stack && is_extra(index) ? extra_links_[index]
                                                  : traces::node_of(slot.next_step());
  if (has.plain) {
    line.read = {tree_.line_of_node(line.node), true};
    return line;
  }
  std::uint32_t number = slot.lines_read();
  if (reads_parent_links_ && repeated && slot.tested_child() == 0) [[unlikely]] {
    if (number == 0) {
      line.of_parent = true;
      line.read = {tree_.line_of_parent_link(line.node), false};
      return line;
    }
    number -= 1;
  }
  if (has.wide) {
    line.record = wide_records_[line.node];
    line.read = tree_.line_of_wide_visit(line.record, number);
  } else {
    line.read = tree_.line_of_visit(line.node, std::min(config_.box_testers, 2U), slot.tested_child(), number);
  }
  return line;
}

template <TrvCode kCode>
[[gnu::always_inline]] inline Trv::CycleReason Trv::issue_visit(std::uint32_t index, const Cycle& cycle) {
  TraversalSlot& slot = slots_[index];
  const TrvFeatures has = active_features<kCode>();
  if (has.instances && enters_instance(slot, index)) return issue_transform(slot, index, cycle.number);
  const VisitLine line = next_line<kCode>(slot, index);
  // Fast path: saves 6, 1 and 1 % of the host's instructions for the three frames named at simulate_cycle().
  if (has.reorders && !has.prefetcher && fetch_.try_first_probe_hit(slot_bit(index), line.read.line)) {
    waiting_[kToInner] &= ~slot_bit(index);
  } else if (const FetchStage::Wait wait = fetch_.read_line(index, line.read.line, cycle.number);
             wait != FetchStage::Wait::kNothing) {
    if (has.prefetcher && wait == FetchStage::Wait::kLine) prefetcher_->note_miss(index, line.node);
    return handle_miss(wait, index, cycle.number);
  }
  if (has.wide) {
    stats_.node_lines += !line.of_parent;
    stats_.parent_links += line.of_parent;
  } else if (!has.plain) {
    stats_.parent_links += line.of_parent;
  }
  if (!line.read.last) {
    slot.count_line_read();
    waiting_[kToInner] |= slot_bit(index);
  } else if (has.wide) {
    complete_wide_visit<kCode>(slot, index, line, cycle);
  } else {
    complete_visit<kCode>(slot, index, cycle.number);
  }
  return CycleReason::kVisiting;
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::read_early_line(const Cycle& cycle) {
  const TrvFeatures has = active_features<kCode>();
  for (std::uint64_t slots = has.reorders ? waiting_[kToInner] : fetch_.issuable_slot_mask(); slots != 0;) {
    const std::uint32_t index = round_robin(slots, inner_turn_);
    const bool at_instance = has.instances && enters_instance(slots_[index], index);
    if (!at_instance && !next_line<kCode>(slots_[index], index).read.last) {
      inner_turn_ = (index + 1) % 64;
      issue_visit<kCode>(index, cycle);
      return;
    }
    slots &= ~slot_bit(index);
  }
}

std::uint64_t Trv::choose_group() {
  const std::uint64_t ready = waiting_[kToInner];
  for (std::uint64_t slots = ready & ~lines_known_; slots != 0; slots &= slots - 1) {
    const auto index = static_cast<std::uint32_t>(std::countr_zero(slots));
    const bool alone = features_.instances && enters_instance(slots_[index], index);
    lines_[index] = alone ? kNoLine - index : next_line<TrvCode::kAny>(slots_[index], index).read.line;
  }
  lines_known_ = ready;
  const std::uint64_t all = std::rotr(ready, static_cast<int>(inner_turn_));
  const bool prefers_full = !last_group_full_;
  std::uint64_t chosen = 0, full = 0;
  std::uint32_t chosen_turn = inner_turn_, full_turn = inner_turn_;
  for (std::uint64_t left = all; left != 0 && (chosen == 0 || (prefers_full && full == 0));) {
    const std::uint32_t first = (inner_turn_ + static_cast<std::uint32_t>(std::countr_zero(left))) % 64;
    std::uint64_t group = 0;
    std::uint32_t size = 0;
    for (std::uint64_t rest = left; rest != 0 && size < config_.gather_width; rest &= rest - 1) {
      const std::uint32_t index = (inner_turn_ + static_cast<std::uint32_t>(std::countr_zero(rest))) % 64;
      stats_.gather_compares += index != first;
      if (lines_[index] != lines_[first]) continue;
      group |= slot_bit(index);
      size += 1;
    }
    if (chosen == 0) chosen = group, chosen_turn = first;
    if (size == config_.gather_width && full == 0) full = group, full_turn = first;
    left &= ~std::rotr(group, static_cast<int>(inner_turn_));
  }
  const bool is_full = full != 0 && (prefers_full || full == chosen);
  last_group_full_ = is_full;
  stats_.groups += 1;
  stats_.full_groups += is_full;
  inner_turn_ = ((is_full ? full_turn : chosen_turn) + 1) % 64;
  return is_full ? full : chosen;
}

Trv::CycleReason Trv::fetch_group(const Cycle& cycle) {
  const std::uint64_t group = choose_group();
  const std::uint64_t served = group & fetch_.served_slots();
  const auto leader = static_cast<std::uint32_t>(std::countr_zero(served != 0 ? served : group));
  const std::uint64_t others = group & ~slot_bit(leader);
  lines_known_ &= ~group;
  if (features_.instances && enters_instance(slots_[leader], leader))
    return issue_transform(slots_[leader], leader, cycle.number);
  const VisitLine line = next_line<TrvCode::kAny>(slots_[leader], leader);
  fetch_.lead_group(leader, others);
  const FetchStage::Wait wait = fetch_.read_line(leader, line.read.line, cycle.number);
  if (wait != FetchStage::Wait::kNothing) {
    fetch_.share_miss(others, line.read.line, wait);
    if (prefetcher_ && wait == FetchStage::Wait::kLine) prefetcher_->note_miss(leader, line.node);
    return handle_miss(wait, leader, cycle.number);
  }
  fetch_.share_line(others);
  stats_.gathered += static_cast<std::uint64_t>(std::popcount(others));
  stats_.node_lines += features_.wide && !line.of_parent;
  stats_.parent_links += line.of_parent;
  // Rays of a group may visit different nodes, if these share the line.
  for (std::uint64_t slots = group; slots != 0; slots &= slots - 1) {
    const auto index = static_cast<std::uint32_t>(std::countr_zero(slots));
    if (next_line<TrvCode::kAny>(slots_[index], index).read.last) {
      group_ |= slot_bit(index);
    } else {
      slots_[index].count_line_read();
      waiting_[kToInner] |= slot_bit(index);
    }
  }
  return CycleReason::kVisiting;
}

Trv::CycleReason Trv::issue_gathered(const Cycle& cycle) {
  CycleReason why = CycleReason::kVisiting;
  if (group_ == 0) why = fetch_group(cycle);
  if (group_ == 0 || cycle.now < boxes_free_at_) return why;
  const auto index = static_cast<std::uint32_t>(std::countr_zero(group_));
  group_ &= ~slot_bit(index);
  if (features_.wide) {
    complete_wide_visit<TrvCode::kAny>(slots_[index], index, next_line<TrvCode::kAny>(slots_[index], index), cycle);
  } else {
    complete_visit<TrvCode::kAny>(slots_[index], index, cycle.number);
  }
  return CycleReason::kVisiting;
}

bool Trv::end_box_pass(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle) {
  slot.reset_lines();
  if (config_.box_testers != 1) return true;
  slot.switch_to_other_child();
  if (slot.tested_child() == 0) return true;
  stats_.first_passes += 1;
  pipes_.schedule_completion(kToInner, index, cycle, box_latency_);
  return false;
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::complete_visit(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle) {
  const TrvFeatures has = active_features<kCode>();
  if (!has.plain && !end_box_pass(slot, index, cycle)) return;
  stats_.visits += 1;
  if (slot.is_restarting()) [[unlikely]] {
    pipes_.schedule_completion(complete_replayed_visit(slot, index), index, cycle, box_latency_);
    return;
  }
  const bool hit_both = slot.advance_to_next_step(stack_.capacity, has.stack, stats_);
  if (has.prefetches && hit_both) both_children_hit_ |= slot_bit(index);
  if (has.prefetcher && hit_both) {
    const std::uint32_t step = slot.last_visit();
    prefetcher_->push_entry(index, tree_.links[traces::node_of(step)].child[1 - traces::near_of(step)]);
  }
  pipes_.schedule_completion(slot.next_pipe(has.instances), index, cycle, box_latency_);
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::complete_wide_visit(TraversalSlot& slot, std::uint32_t index,
                                                            const VisitLine& line, const Cycle& cycle) {
  const TrvFeatures has = active_features<kCode>();
  slot.reset_lines();
  const std::uint32_t children = line.record.children, passes = passes_[children];
  stats_.visits += 1;
  stats_.children += children;
  stats_.box_cycles += passes;
  stats_.comparisons += comparisons_[children];
  std::uint32_t latency = box_latency_;
  if (passes > 1 && !has.ideal) {
    latency += passes - 1;
    (has.one_pipe ? leaf_free_at_ : boxes_free_at_) = clock_.edge_after(cycle.now, passes);
  }
  Pipe next;
  if (slot.is_restarting()) [[unlikely]] {
    next = complete_replayed_visit(slot, index);
  } else if (has.node_stack && is_extra(index)) {
    extra_ &= ~slot_bit(index);
    stats_.extra_visits += 1;
    next = slot.next_pipe();
  } else {
    const std::uint32_t hits = slot.wide_hits();
    const bool hit_several = slot.advance_past_wide_visit(stack_.capacity, has.stack && !has.node_stack, stats_);
    if (has.node_stack && traces::hit_mask_of(hits) != 0) {
      node_stacks_[index].enter_child_of(line.node);
      if (hit_several) node_stacks_[index].push(line.node, hits, stack_.capacity, stats_);
    }
    if (has.prefetches && hit_several) both_children_hit_ |= slot_bit(index);
    if (has.prefetcher && hit_several) prefetcher_->push_entries_of(index, line.node, hits);
    next = slot.next_pipe(has.instances);
  }
  pipes_.schedule_completion(next, index, cycle.number, latency);
}

Trv::Pipe Trv::complete_replayed_visit(TraversalSlot& slot, std::uint32_t index) {
  stats_.restarted_visits += 1;
  const bool ends = slot.complete_replayed_visit(paths_[index]);
  if (ends && stack_.continues_without_pop()) {
    if (prefetcher_) prefetcher_->take_entry(index);
    if (features_.node_stack) return continue_at_child(slot, index, node_stacks_[index].take_child(tree_));
    slot.consume_entry();
  }
  return slot.next_pipe();
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::pop_entry(std::uint32_t index, std::uint64_t cycle) {
  waiting_[kToStack] &= ~slot_bit(index);
  TraversalSlot& slot = slots_[index];
  if (active_features<kCode>().node_stack) {
    pipes_.schedule_completion(pop_node_stack(slot, index), index, cycle, stack_latency_);
    return;
  }
  const bool has_entries = !active_features<kCode>().prefetcher || slot.has_entries();
  if (!slot.pop_stack_entry(stats_)) {
    slot.restart_walk(begins_[index], tree_, stack_, entries_, paths_[index], stats_);
  } else if (active_features<kCode>().prefetcher && has_entries) {
    prefetcher_->pop_entry(index, slot.resident_entries(), slot.known_culls());
  }
  pipes_.schedule_completion(slot.next_pipe(), index, cycle, stack_latency_);
}

Trv::Pipe Trv::pop_node_stack(TraversalSlot& slot, std::uint32_t index) {
  if (const std::optional<std::uint32_t> link = node_stacks_[index].pop(tree_, stats_)) {
    if (prefetcher_) prefetcher_->pop_entry(index, node_stacks_[index].resident_children(), 0);
    return continue_at_child(slot, index, *link);
  }
  if (slot.continue_at_root()) {
    node_stacks_[index].begin_at(0);
    return slot.next_pipe();
  }
  node_stacks_[index].restart(stack_, tree_, paths_[index], stats_);
  slot.begin_restart();
  return slot.next_pipe();
}

/// Continues at a child that was taken from a slot's NodeStack. A child that the walk culls is visited nevertheless.
Trv::Pipe Trv::continue_at_child(TraversalSlot& slot, std::uint32_t index, std::uint32_t link) {
  if (slot.consume_entry()) return slot.next_pipe();
  extra_ |= slot_bit(index);
  extra_links_[index] = link;
  return traces::is_leaf(link) && !traces::is_instance(link) ? kToLeaf : kToInner;
}

template <TrvCode kCode>
[[gnu::always_inline]] inline void Trv::issue_pop(const Cycle& cycle) {
  const std::uint32_t index = round_robin(waiting_[kToStack], stack_turn_);
  stack_turn_ = (index + 1) % 64;
  pop_entry<kCode>(index, cycle.number);
}

Trv::CycleReason Trv::issue_in_shared_pipe(const Cycle& cycle) {
  if (cycle.now < leaf_free_at_) return CycleReason::kSerial;
  const std::uint64_t work = shared_pipe_slots(links_.leaves_out.can_push(cycle.now));
  if (work == 0) return CycleReason::kStarved;
  const std::uint32_t index = next_slot_round_robin(work);
  if ((waiting_[kToStack] & slot_bit(index)) != 0) {
    pop_entry<TrvCode::kAny>(index, cycle.number);
  } else if ((waiting_[kToLeaf] & slot_bit(index)) != 0) {
    send_leaf(cycle.now, index);
  } else {
    return issue_visit<TrvCode::kAny>(index, cycle);
  }
  return CycleReason::kSerial;
}

/// Simulates one cycle of the traversal unit. Default features as constants save 12, 5 and 4 % of the host's
/// instructions for conference-331k, chess-42k and garden-outdoor-643k at 128x64.
template <TrvCode kCode>
[[gnu::always_inline]] inline sim::Time Trv::simulate_cycle(const Cycle& cycle) {
  const TrvFeatures has = active_features<kCode>();
  const sim::Time now = cycle.now;
  const auto issuable_slot_mask = [&] { return has.reorders ? waiting_[kToInner] : fetch_.issuable_slot_mask(); };
  take_from_pipes<kCode>(cycle);
  if (arrivals_.soonest <= now) take_arrivals(cycle);
  CycleReason why = CycleReason::kStarved;  // the reason if no slot tries to issue
  if (has.one_pipe) {
    why = issue_in_shared_pipe(cycle);
  } else {
    if (has.gathers) {
      if (can_serve_group(now)) why = issue_gathered(cycle);
      while (has.ideal && can_serve_group(now)) {
        if (issue_gathered(cycle) == CycleReason::kVisiting) why = CycleReason::kVisiting;
      }
      if (has.wide && now < boxes_free_at_) why = CycleReason::kVisiting;
    } else if (has.wide && now < boxes_free_at_) {
      if (reads_early_lines_) read_early_line<kCode>(cycle);
      why = CycleReason::kVisiting;
    } else if (issuable_slot_mask() != 0) {
      why = issue_visit<kCode>(next_slot_round_robin(issuable_slot_mask()), cycle);
    }
    while (has.ideal && !has.gathers && issuable_slot_mask() != 0) {
      if (issue_visit<kCode>(next_slot_round_robin(issuable_slot_mask()), cycle) == CycleReason::kVisiting)
        why = CycleReason::kVisiting;
    }
    if (waiting_[kToStack] != 0) issue_pop<kCode>(cycle);
    while (has.ideal && waiting_[kToStack] != 0) issue_pop<kCode>(cycle);
  }
  if (has_output(now) || (has.prefetches && !far_nodes_.empty()) || (has.prefetcher && !prefetcher_->is_empty()))
    issue_outputs(cycle);
  if (rays_moved_) account_full_buffer(now);
  const bool boxes_busy = has.wide && !reads_early_lines_ && cycle.next < boxes_free_at_;
  const std::uint64_t issuable = has.gathers ? can_serve_group(cycle.next) : boxes_busy ? 0 : issuable_slot_mask();
  const bool is_busy =
      !has.one_pipe && (issuable | waiting_[kToStack] | pipes_.completion_bit_at(cycle.number + 1)) != 0;
  sim::Time wake = is_busy ? cycle.next : next_wake(cycle);
  const bool boxes_stay_busy = has.wide && cycle.next < boxes_free_at_;
  if (boxes_stay_busy) wake = std::min(wake, boxes_free_at_);
  const bool tried = why != CycleReason::kStarved;
  const CycleReason then = tried && wake == cycle.next ? why
                           : boxes_stay_busy           ? CycleReason::kVisiting
                                                       : wait_reason(cycle.next);
  activity_.spend(now, clock_.period(), tried ? why : then, then);
  return wake;
}

sim::Time Trv::simulate_cycle_of_wide(const Cycle& cycle) { return simulate_cycle<TrvCode::kWide>(cycle); }
sim::Time Trv::simulate_cycle_with_any_features(const Cycle& cycle) { return simulate_cycle<TrvCode::kAny>(cycle); }

sim::Time Trv::tick(sim::Time now) {
  const Cycle cycle(now, clock_);
  if (code_ == TrvCode::kDefault) return simulate_cycle<TrvCode::kDefault>(cycle);
  return code_ == TrvCode::kWide ? simulate_cycle_of_wide(cycle) : simulate_cycle_with_any_features(cycle);
}

void Trv::tick_due(std::span<Trv* const> trvs, std::uint64_t due, sim::Time* wakes, const Cycle& cycle) {
  const TrvCode code = trvs.front()->code_;
  for (; due != 0; due &= due - 1) {
    const auto t = static_cast<std::size_t>(std::countr_zero(due));
    wakes[t] = code == TrvCode::kDefault ? trvs[t]->simulate_cycle<TrvCode::kDefault>(cycle)
               : code == TrvCode::kWide  ? trvs[t]->simulate_cycle_of_wide(cycle)
                                         : trvs[t]->simulate_cycle_with_any_features(cycle);
  }
}

bool Trv::enters_instance(const TraversalSlot& slot, std::uint32_t index) const {
  if (slot.is_restarting()) return paths_[index].enters_instance();
  if (features_.node_stack && is_extra(index)) return traces::is_instance(extra_links_[index]);
  return traces::is_enter(slot.next_step());
}

/// Transforms a ray into an instance's space, as one operation of the box pipe. The origin takes 9 multiplications and
/// 9 additions; the direction takes 9 multiplications, 6 additions and a reciprocal.
Trv::CycleReason Trv::issue_transform(TraversalSlot& slot, std::uint32_t index, std::uint64_t cycle) {
  const bool extra = features_.node_stack && is_extra(index) && !slot.is_restarting();
  const std::uint32_t instance = slot.is_restarting() ? paths_[index].next_instance()
                                 : extra              ? traces::link_instance(extra_links_[index])
                                                      : traces::instance_index_of(slot.next_step());
  const FetchStage::Wait wait = fetch_.read_line(index, tree_.line_of_instance(instance), cycle);
  if (wait != FetchStage::Wait::kNothing) return handle_miss(wait, index, cycle);
  stats_.transforms += 1;
  if (slot.is_restarting()) {
    paths_[index].remove_next_step();  // not the last step: a node of the instance's tree follows
  } else if (extra) {
    extra_links_[index] = tree_.placed[instance].root;
  } else {
    if (features_.node_stack) node_stacks_[index].enter_instance(instance);
    slot.enter_instance();
  }
  pipes_.schedule_completion(kToInner, index, cycle, transform_latency_);
  return CycleReason::kVisiting;
}

bool Trv::issue_leaf(sim::Time now) {
  const std::uint64_t leaves = issuable_leaves(now);
  if (leaves == 0) return false;
  const std::uint32_t index = round_robin(leaves, leaf_turn_);
  leaf_turn_ = (index + 1) % 64;
  send_leaf(now, index);
  return true;
}

void Trv::send_leaf(sim::Time now, std::uint32_t index) {
  waiting_[kToLeaf] &= ~slot_bit(index);
  TraversalSlot& slot = slots_[index];
  if (prefetcher_) prefetcher_->enter_leaf(index);
  std::uint32_t first, count, phases;
  if (features_.node_stack && is_extra(index)) [[unlikely]] {
    constexpr std::uint32_t kAllByDistance = 0x11111111;  // exit phases of triangles beyond the hit
    first = traces::leaf_first(extra_links_[index]);
    count = traces::leaf_count(extra_links_[index]);
    phases = kAllByDistance;
    extra_ &= ~slot_bit(index);
    stats_.extra_leaves += 1;
    stats_.extra_tests += count;
  } else {
    first = traces::first_of(slot.next_step());
    count = traces::count_of(slot.next_step());
    phases = slot.exit_phases();
    slot.advance_past_leaf();
  }
  links_.leaves_out.push(now, LeafJob{first, phases, static_cast<std::uint8_t>(count), static_cast<std::uint8_t>(index),
                                      fetch_.slot_tile(index)});
  at_ist_ |= slot_bit(index);
  if (!features_.ideal) leaf_free_at_ = clock_.edge_after(now, std::max(count, 1U));
  stats_.leaves += 1;
}

void Trv::issue_outputs(const Cycle& cycle) {
  if (!features_.one_pipe) run_once_or_drain(features_.ideal, [&] { return issue_leaf(cycle.now); });
  if (waiting_[kToRetire] != 0) {
    run_once_or_drain(features_.ideal, [&] { return retire_ray(cycle.now); });
    if (free_ != 0) arrivals_.soonest = std::min(arrivals_.soonest, arrivals_.rays);
    rays_moved_ = true;
  }
  if (!far_nodes_.empty()) prefetch_far_nodes(cycle.number);  // after the demand accesses of the cycle
  if (prefetcher_) {
    run_once_or_drain(features_.ideal, [&] { return prefetcher_->issue_prefetch(fetch_, cycle.number); });
    run_once_or_drain(features_.ideal, [&] { return prefetcher_->send_leaf(fetch_, cycle.now); });
  }
  fetch_.send_request(cycle.now, links_.memory_out);
}

bool Trv::retire_ray(sim::Time now) {
  if (waiting_[kToRetire] == 0 || !links_.rays_out.can_push(now)) return false;
  const std::uint32_t index = round_robin(waiting_[kToRetire], retire_turn_);
  retire_turn_ = (index + 1) % 64;
  waiting_[kToRetire] &= ~slot_bit(index);
  occupied_ &= ~slot_bit(index);
  free_ |= slot_bit(index);
  links_.rays_out.push(now, RayDone{slots_[index].ray_id(), fetch_.slot_tile(index)});
  stats_.rays_out += 1;
  return true;
}

}  // namespace hw
