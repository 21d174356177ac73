#include <algorithm>

#include "hw_models/tni/trv.h"
#include "traces/walk.h"

namespace hw {

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

}  // namespace hw
