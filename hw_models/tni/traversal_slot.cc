#include "hw_models/tni/traversal_slot.h"

#include <algorithm>
#include <cassert>

namespace hw {

using traces::StepKind;

void RestartPath::plan_path(std::span<const StackEntryOrigin> entries, const TreeInMemory& tree, bool from_root) {
  const std::uint32_t from = from_root ? 0 : entries.front().node;
  const std::uint32_t instance = entries.back().instance;
  const std::uint32_t root = instance == traces::kNone ? traces::kNone : tree.placed[instance].root;
  // Follow parents from the youngest entry's node. The parent of an instance's root is in the tree over instances.
  for (std::uint32_t node = entries.back().node;;) {
    path_.push_back(node);
    if (node == from) break;
    if (node == root) {
      path_.push_back(kEnter | instance);
      node = tree.parents[tree.links.size() + instance];
    } else {
      node = tree.parents[node];
    }
  }
}

/// Returns the sub-pipe of the ray's next step in the rare cases that the table in next_pipe() does not cover.
TraversalSlot::Pipe TraversalSlot::next_pipe_slow_path() {
  if (restarting_) return kToInner;
  if (traces::kind_of(next_step_) == StepKind::kCull) {
    pending_culls_ = traces::culled_of(next_step_);
    go_to_step(next_word_ + 1);
  }
  if (pending_culls_ > 0) return kToStack;
  return next_pipe();
}

/// Lists the origins of the entries on the ray's stack, oldest first, by replaying the walk up to the next step. Rays
/// do not store this list, because restarts are rare.
void TraversalSlot::list_stack_entries(const std::uint32_t* walk, std::vector<StackEntryOrigin>& entries) const {
  entries.clear();
  std::uint32_t instance = traces::kNone;
  bool must_pop = false;
  for (const std::uint32_t* step = walk; step != next_word_; ++step) {
    const StepKind kind = traces::kind_of(*step);
    if (kind == StepKind::kCull) {
      // The culls just before the next step may be incomplete: resize() below removes the entries popped so far.
      if (step + 1 != next_word_) entries.resize(entries.size() - traces::culled_of(*step));
      continue;
    }
    if (must_pop) {
      instance = entries.back().instance;  // instance in which the ray continues
      entries.pop_back();
    }
    if (traces::is_enter(*step)) {
      instance = traces::instance_index_of(*step);
      must_pop = false;
      continue;
    }
    must_pop = kind == StepKind::kLeaf || traces::hits_of(*step) == 0;
    if (kind == StepKind::kLeaf) {
      ++step;  // skip the word with the exit phases
    } else if (traces::hits_of(*step) == 3) {
      entries.push_back({traces::node_of(*step), instance});
    }
  }
  entries.resize(stack_depth_);
}

void TraversalSlot::restart_walk(const std::uint32_t* walk, const TreeInMemory& tree, bool has_trail,
                                 std::uint32_t capacity, std::vector<StackEntryOrigin>& entries, RestartPath& path,
                                 StackStats& stats) {
  assert(stack_depth_ > 0 && "a pop from an empty stack");
  // Each visit on the path pushes its far child again, so the short stack then contains the youngest entries. With a
  // restart trail, the last visit continues at its far child without a pop.
  list_stack_entries(walk, entries);
  path.plan_path(entries, tree, has_trail);
  restarting_ = true;
  stats.restarts += 1;
  const std::uint32_t found = stack_depth_ - (has_trail ? 1U : 0U);
  short_stack_size_ = static_cast<std::uint16_t>(std::min(found, capacity));
  if (capacity == 0) return;
  stats.pushes += found;
  stats.dropped += found - short_stack_size_;
}

void TraversalSlot::complete_replayed_visit(RestartPath& path, bool has_trail) {
  path.remove_next_step();
  restarting_ = !path.is_empty();
  if (!restarting_ && has_trail) consume_entry();
}

}  // namespace hw
