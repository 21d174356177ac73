#include "hw_models/tni/traversal_slot.h"

#include <vector>

#include <gtest/gtest.h>

// Tests of the state machine of one ray, without pipes, caches or links. Expected steps are derived by hand from
// traces/walk.h.

namespace hw {
namespace {

using traces::cull_step;
using traces::end_step;
using traces::instance_step;
using traces::leaf_step;
using traces::visit_step;
using Walk = std::vector<std::uint32_t>;
using enum TraversalSlot::Pipe;

constexpr std::uint32_t kFullStack = ~0U;

/// A complete binary tree of fifteen nodes: the children of node n are 2n + 1 and 2n + 2.
struct SmallTree {
  SmallTree() {
    parents.push_back(0);
    for (std::uint32_t node = 1; node < 15; ++node) parents.push_back((node - 1) / 2);
    tree.parents = parents;
  }
  std::vector<std::uint32_t> parents;
  TreeInMemory tree;
};

// Adds padding to a walk, because a slot prefetches later steps.
Walk padded(Walk walk) {
  walk.resize(walk.size() + 16, end_step(false));
  return walk;
}

TEST(TraversalSlot, FollowsTheOnlyChildHitWithoutAPop) {
  const Walk walk = padded({visit_step(0, 1, 0), visit_step(1, 2, 0), leaf_step(7, 2), 0x11, end_step(false)});
  TraversalSlot slot(walk.data(), 3);
  StackStats stats;
  EXPECT_EQ(slot.ray_id(), 3U);
  EXPECT_EQ(slot.next_pipe(), kToInner);
  EXPECT_FALSE(slot.advance_to_next_step(kFullStack, true, stats));
  EXPECT_EQ(slot.next_pipe(), kToInner);
  slot.advance_to_next_step(kFullStack, true, stats);
  EXPECT_EQ(slot.next_pipe(), kToLeaf);
  EXPECT_EQ(slot.exit_phases(), 0x11U);
  slot.advance_past_leaf();
  slot.take_answer();
  EXPECT_EQ(slot.next_pipe(), kToRetire) << "the stack is empty";
}

TEST(TraversalSlot, PopsTheFarChildAfterAVisitWithoutAHit) {
  const Walk walk = padded({visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)});
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  EXPECT_TRUE(slot.advance_to_next_step(kFullStack, true, stats));
  EXPECT_EQ(stats.pushes, 1U);
  EXPECT_EQ(stats.dropped, 0U);
  EXPECT_EQ(slot.next_pipe(), kToInner) << "the near child first";
  slot.advance_to_next_step(kFullStack, true, stats);
  EXPECT_EQ(slot.next_pipe(), kToStack);
  EXPECT_TRUE(slot.pop_stack_entry(stats));
  EXPECT_EQ(slot.next_pipe(), kToInner);
  slot.advance_to_next_step(kFullStack, true, stats);
  EXPECT_EQ(slot.next_pipe(), kToRetire);
}

TEST(TraversalSlot, PopsEachCulledEntryBeforeTheOneThatItContinuesAt) {
  // Three pushes; two of the entries are farther than the hit.
  const Walk walk = padded({visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 3, 0), leaf_step(0, 1), 0x3,
                            cull_step(2), visit_step(2, 0, 0), end_step(true)});
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  for (int visit = 0; visit < 3; ++visit) slot.advance_to_next_step(kFullStack, true, stats);
  slot.advance_past_leaf();
  slot.take_answer();
  for (int pop = 0; pop < 3; ++pop) {
    EXPECT_EQ(slot.next_pipe(), kToStack);
    EXPECT_TRUE(slot.pop_stack_entry(stats));
  }
  EXPECT_EQ(slot.next_pipe(), kToInner);
  EXPECT_FALSE(slot.has_entries());
}

TEST(TraversalSlot, DropsTheOldestEntryOfAFullShortStack) {
  const Walk walk = padded({visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 3, 0), end_step(false)});
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  for (int visit = 0; visit < 3; ++visit) slot.advance_to_next_step(2, true, stats);
  EXPECT_EQ(stats.pushes, 3U);
  EXPECT_EQ(stats.dropped, 1U);
  EXPECT_TRUE(slot.pop_stack_entry(stats));
  EXPECT_TRUE(slot.pop_stack_entry(stats));
  EXPECT_FALSE(slot.pop_stack_entry(stats)) << "a restart is needed for the dropped entry";
}

TEST(TraversalSlot, CountsNoPushesWithoutAStack) {
  const Walk walk = padded({visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)});
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  EXPECT_TRUE(slot.advance_to_next_step(0, false, stats));
  EXPECT_EQ(stats.pushes + stats.dropped, 0U);
  slot.advance_to_next_step(0, false, stats);
  EXPECT_EQ(slot.next_pipe(), kToStack);
  EXPECT_FALSE(slot.pop_stack_entry(stats)) << "a restart is needed";
}

TEST(TraversalSlot, EntersAnInstanceThroughTheBoxPipe) {
  const Walk walk = padded({visit_step(0, 1, 0), instance_step(4), visit_step(9, 0, 0), end_step(false)});
  TraversalSlot slot(walk.data(), 0);
  StackStats stats;
  slot.advance_to_next_step(kFullStack, true, stats);
  EXPECT_EQ(slot.next_pipe(), kToInner);
  EXPECT_EQ(traces::instance_index_of(slot.next_step()), 4U);
  slot.enter_instance();
  EXPECT_EQ(traces::node_of(slot.next_step()), 9U);
}

/// Traversal that pushes entries at nodes 0, 1 and 3 and then misses at node 7. The entry of node 3 is next.
const Walk kThreeEntries = padded({visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 3, 0), visit_step(7, 0, 0),
                                   visit_step(8, 0, 0), visit_step(4, 0, 0), visit_step(2, 0, 0), end_step(false)});

/// Returns the nodes that a ray with an empty short stack visits again before it can pop the entry of node 3.
std::vector<std::uint32_t> replayed(StackScheme scheme, std::uint32_t capacity, TraversalSlot& slot,
                                    StackStats& stats) {
  const SmallTree small;
  const StackRules rules{scheme, capacity};
  std::vector<StackEntryOrigin> scratch;
  RestartPath path;
  for (int visit = 0; visit < 4; ++visit) slot.advance_to_next_step(capacity, capacity != 0, stats);
  while (slot.pop_stack_entry(stats)) {
    // The newest entries are in the short stack. Visits of their nodes hit nothing.
    slot.advance_to_next_step(capacity, capacity != 0, stats);
  }
  EXPECT_EQ(slot.next_pipe(), kToStack);
  slot.restart_walk(kThreeEntries.data(), small.tree, rules, scratch, path, stats);
  std::vector<std::uint32_t> nodes;
  while (slot.is_restarting()) {
    EXPECT_EQ(slot.next_pipe(), kToInner);
    nodes.push_back(path.next_node());
    if (slot.complete_replayed_visit(path) && rules.continues_without_pop()) slot.consume_entry();
  }
  return nodes;
}

TEST(Restart, VisitsTheNodesFromTheOldestDroppedEntryDownToThePoppedOne) {
  // Two entries fit into the short stack: those of nodes 1 and 3 are popped; that of node 0 was dropped.
  TraversalSlot slot(kThreeEntries.data(), 0);
  StackStats stats;
  EXPECT_EQ(replayed(StackScheme::kRestartLink, 2, slot, stats), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(stats.restarts, 1U);
  EXPECT_EQ(slot.next_pipe(), kToStack) << "the entry that was found again is popped";
  EXPECT_TRUE(slot.pop_stack_entry(stats));
  EXPECT_EQ(traces::node_of(slot.next_step()), 2U);
}

TEST(Restart, WithoutAnyStackDescendsFromTheRootForEachPop) {
  TraversalSlot slot(kThreeEntries.data(), 0);
  StackStats stats;
  EXPECT_EQ(replayed(StackScheme::kRestartTrail, 0, slot, stats), (std::vector<std::uint32_t>{0, 1, 3}));
  EXPECT_EQ(slot.next_pipe(), kToInner) << "a trail needs no pop";
  EXPECT_EQ(traces::node_of(slot.next_step()), 8U);
}

}  // namespace
}  // namespace hw
