#include "hw_models/tni/ray_dispatcher.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hw {

RayDispatcher::RayDispatcher(const Policy& policy, Links links, sim::Clock clock)
    : clock_(clock), policy_(policy), links_(std::move(links)), load_(links_.to_trv.size()) {}

sim::Time RayDispatcher::tick(sim::Time now) {
  while (collect(now) && policy_.unbounded) {
  }
  const bool dispatched = dispatch(now);
  while (dispatched && policy_.unbounded && dispatch(now)) {
  }
  const Why then = load_[emptiest()] == policy_.rays_per_trv ? Why::kTrvsFull : Why::kStarved;
  activity_.spend(now, clock_.period(), dispatched ? Why::kDispatching : then, then);
  return next_wake(now);
}

std::size_t RayDispatcher::emptiest() const {
  return static_cast<std::size_t>(std::ranges::min_element(load_) - load_.begin());
}

std::size_t RayDispatcher::next_in_turn(sim::Time at) const {
  std::size_t best = turn_;
  sim::Time soonest = sim::kNever;
  for (std::size_t k = 0; k < load_.size(); ++k) {
    const std::size_t trv = (turn_ + k) % load_.size();
    const sim::Time room_at = std::max(at, links_.to_trv[trv]->push_at());
    if (load_[trv] == policy_.rays_per_trv || room_at >= soonest) continue;
    best = trv;
    soonest = room_at;
  }
  return best;
}

std::size_t RayDispatcher::chosen(sim::Time at) const {
  return policy_.dispatch == Dispatch::kEmptiest ? emptiest() : next_in_turn(at);
}

bool RayDispatcher::dispatch(sim::Time now) {
  if (!links_.rays_in.can_pop(now)) return false;
  const std::size_t trv = chosen(now);
  if (load_[trv] == policy_.rays_per_trv || !links_.to_trv[trv]->can_push(now)) return false;
  links_.to_trv[trv]->push(now, links_.rays_in.pop(now));
  load_[trv] += 1;
  turn_ = (trv + 1) % load_.size();
  stats_.rays_in += 1;
  return true;
}

bool RayDispatcher::collect(sim::Time now) {
  if (now < collect_at_ || !links_.hits_out.can_push(now)) return false;
  const std::size_t trvs = links_.from_trv.size();
  for (std::size_t k = 0; k < trvs; ++k) {
    const std::size_t trv = (collect_turn_ + k) % trvs;
    if (!links_.from_trv[trv]->can_pop(now)) continue;
    collect_turn_ = (trv + 1) % trvs;
    links_.hits_out.push(now, links_.from_trv[trv]->pop(now));
    load_[trv] -= 1;
    stats_.hits_out += 1;
    if (!policy_.unbounded) collect_at_ = clock_.after(now, policy_.hit_interval);
    return true;
  }
  return false;
}

sim::Time RayDispatcher::next_wake(sim::Time now) const {
  const sim::Time next = clock_.after(now, 1);
  sim::Time at = sim::kNever;
  const std::size_t trv = chosen(next);
  if (load_[trv] < policy_.rays_per_trv) {
    at = std::max({next, links_.rays_in.pop_at(), links_.to_trv[trv]->push_at()});
  }
  for (const sim::Link<RayDone>* link : links_.from_trv) {
    at = std::min(at, std::max({next, collect_at_, link->pop_at(), links_.hits_out.push_at()}));
  }
  return at;
}

std::string RayDispatcher::state() const { return fmt::format("rays inside the TRVs: {}", fmt::join(load_, " ")); }

}  // namespace hw
