#include "hw_models/tni/trv.h"
#include "traces/walk.h"

namespace hw {

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

}  // namespace hw
