#include <algorithm>
#include <cassert>

#include "hw_models/tni/trv.h"
#include "traces/walk.h"

namespace hw {

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
