#include "hw_models/tni/trv.h"

#include <algorithm>
#include <bit>

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

}  // namespace hw
