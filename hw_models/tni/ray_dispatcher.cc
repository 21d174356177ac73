#include "hw_models/tni/ray_dispatcher.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/branch_free.h"

namespace hw {

RayDispatcher::RayDispatcher(const Policy& policy, Links links, sim::Clock clock)
    : clock_(clock),
      policy_(policy),
      rays_in_(links.rays_in),
      hits_out_(links.hits_out),
      to_trv_(std::move(links.to_trv)),
      from_trv_(std::move(links.from_trv)),
      collects_(Arbitration::kRoundRobin, from_trv_.size()),
      load_(to_trv_.size()) {
  stats_.sorts = policy_.config.is_sorting();
  if (stats_.sorts) window_.emplace(policy_.config.window, policy_.config.timeout);
}

sim::Time RayDispatcher::tick(sim::Time now) {
  const bool collected = collect_hit(now);
  while (collected && policy_.ideal && collect_hit(now)) {
  }
  const bool dispatched = dispatch_ray(now);
  while (dispatched && policy_.ideal && dispatch_ray(now)) {
  }
  const bool taken = window_ && take_into_window(now);
  while (taken && policy_.ideal && take_into_window(now)) {
  }
  const auto waiting = [&](sim::Time at) {
    return rays_in_.can_pop(at) || has_rays_in_window() ? CycleReason::kTrvsFull : CycleReason::kStarved;
  };
  activity_.spend(now, clock_.period(), collected || dispatched || taken ? CycleReason::kDispatching : waiting(now),
                  waiting(clock_.edge_after(now, 1)));
  return next_wake(now);
}

std::size_t RayDispatcher::emptiest_trv() const { return sim::index_of_min(load_.data(), load_.size()); }

inline std::size_t RayDispatcher::next_trv_in_turn(sim::Time at) const {
  std::size_t best = turn_;
  sim::Time soonest = sim::kNever;
  for (std::size_t k = 0; k < load_.size(); ++k) {
    const std::size_t trv = (turn_ + k) % load_.size();
    const sim::Time room_at = std::max(at, to_trv_[trv]->push_at());
    if (load_[trv] == policy_.rays_per_trv || room_at >= soonest) continue;
    best = trv;
    soonest = room_at;
  }
  return best;
}

inline std::size_t RayDispatcher::chosen_trv(sim::Time at) const {
  return policy_.dispatch == Dispatch::kEmptiest ? emptiest_trv() : next_trv_in_turn(at);
}

bool RayDispatcher::take_into_window(sim::Time now) {
  if (window_->is_full() || !rays_in_.can_pop(now)) return false;
  const RayJob job = rays_in_.pop(now);
  assert(job.key != RayJob::kNoKey && "recorded work has no keys, and its reader refuses tni.dispatcher.sort");
  stats_.window_writes += 1;
  stats_.key_moves += window_->insert_ray(job, clock_.cycles(now));
  return true;
}

inline RayJob RayDispatcher::next_ray(sim::Time now) {
  if (!window_) return rays_in_.pop(now);
  const SortWindow::Sent sent = window_->remove_next(clock_.cycles(now));
  stats_.window_reads += 1;
  stats_.key_moves += sent.moved;
  stats_.timed_out += sent.timed_out;
  return sent.job;
}

bool RayDispatcher::dispatch_ray(sim::Time now) {
  if (!has_ray(now)) return false;
  const std::size_t trv = chosen_trv(now);
  if (load_[trv] == policy_.rays_per_trv || !to_trv_[trv]->can_push(now)) return false;
  to_trv_[trv]->push(now, next_ray(now));
  load_[trv] += 1;
  turn_ = (trv + 1) % load_.size();
  stats_.rays_in += 1;
  return true;
}

bool RayDispatcher::collect_hit(sim::Time now) {
  if (from_trv_.nonempty_mask() == 0 || now < collect_at_ || !hits_out_.can_push(now)) return false;
  const std::uint32_t trv = collects_.choose_requester(
      from_trv_.nonempty_mask(), [&](std::uint32_t i) { return from_trv_.can_pop(i, now); },
      [](std::uint32_t) { return sim::Time{0}; });
  if (trv == collects_.requester_count()) return false;
  collects_.note_served(trv);
  hits_out_.push(now, from_trv_[trv].pop(now));
  load_[trv] -= 1;
  stats_.hits_out += 1;
  if (!policy_.ideal) collect_at_ = clock_.edge_after(now, policy_.hit_interval);
  return true;
}

inline sim::Time RayDispatcher::next_wake(sim::Time now) const {
  const sim::Time next = clock_.edge_after(now, 1);
  sim::Time at = std::max({next, collect_at_, from_trv_.pop_at(), hits_out_.push_at()});
  if (window_) {
    if (!window_->is_full()) at = std::min(at, std::max(next, rays_in_.pop_at()));
    if (window_->is_empty()) return at;
    const std::size_t trv = chosen_trv(next);
    return load_[trv] == policy_.rays_per_trv ? at : std::min(at, std::max(next, to_trv_[trv]->push_at()));
  }
  if (rays_in_.pop_at() == sim::kNever) return at;
  const std::size_t trv = chosen_trv(next);
  if (load_[trv] == policy_.rays_per_trv) return rays_in_.can_pop(next) ? at : std::min(at, rays_in_.pop_at());
  return std::min(at, std::max({next, rays_in_.pop_at(), to_trv_[trv]->push_at()}));
}

std::string RayDispatcher::state() const { return fmt::format("rays inside the TRVs: {}", fmt::join(load_, " ")); }

}  // namespace hw
