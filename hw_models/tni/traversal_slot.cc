#include "hw_models/tni/traversal_slot.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace hw {

using traces::StepKind;

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
/// do not store this list, because restarts are rare. Returns the node whose child the ray has visited last, and the
/// instance in which the ray is. Sets `start` to the node at which the ray has begun: the root or a predicted node.
StackEntryOrigin TraversalSlot::list_stack_entries(const std::uint32_t* walk, std::vector<StackEntryOrigin>& entries,
                                                   std::uint32_t& start) const {
  entries.clear();
  start = traces::node_of(*walk);
  std::uint32_t instance = traces::kNone;
  std::uint32_t parent = 0;
  bool must_pop = false;
  for (const std::uint32_t* step = walk; step != next_word_; ++step) {
    const StepKind kind = traces::kind_of(*step);
    if (kind == StepKind::kCull) {
      // The culls just before the next step may be incomplete: resize() below removes the entries popped so far.
      if (step + 1 != next_word_) entries.resize(entries.size() - traces::culled_of(*step));
      continue;
    }
    if (must_pop && entries.empty()) {
      start = parent = 0;  // the subtree of the predicted node is finished
    } else if (must_pop) {
      instance = entries.back().instance;  // instance in which the ray continues
      parent = entries.back().node;
      entries.pop_back();
    }
    if (traces::is_enter(*step)) {
      instance = traces::instance_index_of(*step);
      must_pop = false;
      continue;
    }
    if (kind == StepKind::kLeaf) {
      must_pop = true;
      ++step;  // skip the word with the exit phases
      continue;
    }
    const StackEntryOrigin here{traces::node_of(*step), instance};
    const std::uint32_t hits = traces::is_wide(*step)
                                   ? traces::hit_count_of(*++step)
                                   : static_cast<std::uint32_t>(std::popcount(traces::hits_of(*step)));
    must_pop = hits == 0;
    if (hits == 0) continue;
    parent = here.node;
    entries.insert(entries.end(), hits - 1, here);
  }
  // Culls that have been popped before the next step took their entries' nodes as the last parent.
  if (entries.size() > stack_depth_) parent = entries[stack_depth_].node;
  entries.resize(stack_depth_);
  return {parent, instance};
}

void TraversalSlot::restart_walk(const std::uint32_t* walk, const TreeInMemory& tree, const StackRules& rules,
                                 std::vector<StackEntryOrigin>& entries, RestartPath& path, StackStats& stats) {
  assert(stack_depth_ > 0 && "a pop from an empty stack");
  // Each visit on the path pushes its remaining children again, so the short stack then contains the youngest entries.
  // The first of them is entered without a push if the last visit continues without a pop.
  std::uint32_t start = 0;
  const StackEntryOrigin last = list_stack_entries(walk, entries, start);
  const StackEntryOrigin youngest = entries.back();
  std::uint32_t found = stack_depth_;
  if (rules.scheme == StackScheme::kParent) {
    path.plan_climb(last.node, last.instance, youngest.node, tree);
    const auto others = std::find_if(entries.rbegin(), entries.rend(), [&](const StackEntryOrigin& entry) {
      return entry.node != youngest.node || entry.instance != youngest.instance;
    });
    found = static_cast<std::uint32_t>(others - entries.rbegin());
  } else {
    path.plan_path(youngest, rules.scheme == StackScheme::kRestartTrail ? start : entries.front().node, tree);
  }
  restarting_ = true;
  stats.restarts += 1;
  if (rules.continues_without_pop()) found -= 1;
  short_stack_size_ = static_cast<std::uint16_t>(std::min(found, rules.capacity));
  if (rules.capacity == 0) return;
  stats.pushes += found;
  stats.dropped += found - short_stack_size_;
}

bool TraversalSlot::complete_replayed_visit(RestartPath& path) {
  path.remove_next_step();
  restarting_ = !path.is_empty();
  return !restarting_;
}

}  // namespace hw
