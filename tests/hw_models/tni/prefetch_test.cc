#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/tni/treelets.h"
#include "tests/hw_models/tni/random_load.h"

namespace hw {
namespace {

using test::kMiss;
using test::kPop;
using test::kVisit;
using test::kWires;
using test::one_trv;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::visit_step;

/// Returns the prefetches of a ray that hits both children of the root, which are inner nodes.
Trv::Stats of(Prefetch prefetch, std::uint32_t registers) {
  TniHarness::Setup setup = one_trv();
  setup.links.resize(3);
  setup.links[0].child[0] = 1;
  setup.links[0].child[1] = 2;
  setup.config.trv.prefetch = prefetch;
  setup.config.trv.l1.mshrs = registers;
  TniHarness harness(setup);
  harness.add({visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), traces::end_step(false)}).run();
  return harness.tni().trvs().front()->stats();
}

TEST(Prefetch, ProbesAndFetchesAreCountedOnceForEachFarNode) {
  EXPECT_EQ(of(Prefetch::kSibling, 8).prefetch_probes, 1U);
  EXPECT_EQ(of(Prefetch::kSibling, 8).prefetches, 1U);
  EXPECT_EQ(of(Prefetch::kNone, 8).prefetch_probes, 0U);
}

TEST(Prefetch, NothingIsProbedWithoutASpareMshr) {
  EXPECT_EQ(of(Prefetch::kSibling, 2).prefetch_probes, 0U);
  EXPECT_EQ(of(Prefetch::kSibling, 2).prefetches, 0U);
}

/// Returns a unit with one traversal unit and a complete binary tree of seven inner nodes.
TniHarness::Setup seven_nodes(Prefetch prefetch) {
  TniHarness::Setup setup = one_trv();
  setup.links.resize(7);
  for (std::uint32_t node = 0; node < 7; ++node) {
    for (std::uint32_t c = 0; c < 2; ++c) {
      const std::uint32_t child = 2 * node + 1 + c;
      setup.links[node].child[c] = child < 7 ? child : traces::leaf_link(4 * child, 1);
    }
  }
  setup.config.trv.prefetch = prefetch;
  return setup;
}

/// A ray goes down to node 3 and climbs: 3 and its sibling 4 fail, then 2, whose entry is the oldest.
const Walk kClimb = {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 0, 0),
                     visit_step(4, 0, 0), visit_step(2, 0, 0), traces::end_step(false)};

TEST(StackPrefetch, LeavesArePrefetchedByTheIntersectionUnit) {
  // Node 0 pushes leaf A, node 1 pushes leaf C and enters leaf B. The pop of C follows a leaf and prefetches A.
  const auto latency = [&](Prefetch prefetch, Ist::Stats& triangles, Trv::Stats& nodes) {
    TniHarness::Setup setup = one_trv();
    setup.links.resize(2);
    setup.links[0].child[0] = 1;
    setup.links[0].child[1] = traces::leaf_link(40, 1);
    setup.links[1].child[0] = traces::leaf_link(80, 1);
    setup.links[1].child[1] = traces::leaf_link(120, 1);
    setup.config.trv.prefetch = prefetch;
    TniHarness harness(setup);
    harness.add({visit_step(0, 3, 0), visit_step(1, 3, 0), traces::leaf_step(80, 1), 1, traces::leaf_step(120, 1), 1,
                 traces::leaf_step(40, 1), 1, traces::end_step(false)});
    harness.run();
    triangles = harness.tni().ists().front()->stats();
    nodes = trv(harness).stats();
    return harness.latency(0);
  };
  Ist::Stats triangles;
  Trv::Stats nodes;
  const std::uint64_t none = latency(Prefetch::kNone, triangles, nodes);
  EXPECT_EQ(latency(Prefetch::kStack, triangles, nodes), none - kMiss);
  EXPECT_EQ(nodes.prefetched_leaves, 1U);
  EXPECT_EQ(nodes.prefetches, 0U);
  EXPECT_EQ(triangles.prefetch_probes, 1U);
  EXPECT_EQ(triangles.prefetches, 1U);
  EXPECT_EQ(triangles.prefetches_useful, 1U);
}

TEST(StackPrefetch, APopThatFollowsAPushPrefetchesNothing) {
  TniHarness harness(seven_nodes(Prefetch::kStack));
  harness.add({visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 0, 0), visit_step(4, 3, 0), visit_step(3, 0, 0),
               visit_step(3, 0, 0), visit_step(2, 0, 0), traces::end_step(false)});
  harness.run();
  const Trv::Stats stats = trv(harness).stats();
  EXPECT_EQ(stats.pops, 3U);
  EXPECT_EQ(stats.prefetch_stack_reads, 0U) << "the last pop follows a pop, but no entry is left";
}

TEST(StackPrefetch, ThePopOfAClimbingRayHidesTheMissOfTheNextEntry) {
  const std::uint64_t visits = 7, pops = 3;
  // Node 0 pushes 2, node 1 pushes 4, node 3 pushes 6. The pop of 4 follows that of 6 and prefetches 2.
  const auto latency = [&](Prefetch prefetch, std::uint32_t fourth, std::uint32_t registers, Trv::Stats& stats) {
    TniHarness::Setup setup = seven_nodes(prefetch);
    setup.links[3] = {};
    setup.links[3].child[0] = 5;
    setup.links[3].child[1] = 6;
    setup.links[1].child[1] = fourth;
    setup.config.trv.l1.mshrs = registers;
    TniHarness harness(setup);
    harness.add({visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 3, 0), visit_step(5, 0, 0),
                 visit_step(6, 0, 0), visit_step(fourth, 0, 0), visit_step(2, 0, 0), traces::end_step(false)});
    harness.run();
    stats = trv(harness).stats();
    return harness.latency(0);
  };
  Trv::Stats stats;
  const std::uint64_t none = kWires + visits * (kVisit + kMiss) + pops * kPop;
  EXPECT_EQ(latency(Prefetch::kNone, 4, 8, stats), none);
  EXPECT_EQ(latency(Prefetch::kStack, 4, 8, stats), none - kMiss);
  EXPECT_EQ(stats.prefetches, 1U);
  EXPECT_EQ(stats.prefetches_useful, 1U);
  EXPECT_EQ(stats.prefetch_stack_reads, 1U);
  EXPECT_EQ(latency(Prefetch::kStack, 4, 1, stats), none) << "the only MSHR is for demand misses";
  EXPECT_EQ(stats.prefetches_dropped, 1U);
  // Node 5 again is a hit, so the line of 2 is needed before it arrives: after a pop, a visit and a pop.
  EXPECT_EQ(latency(Prefetch::kNone, 5, 8, stats), none - kMiss);
  EXPECT_EQ(latency(Prefetch::kStack, 5, 8, stats), none - kMiss - (2 * kPop + kVisit));
  EXPECT_EQ(stats.prefetches_late, 1U);
  EXPECT_EQ(stats.prefetches_useful, 0U);
}

TEST(StackPrefetch, AnEntryThatBeginsBeyondTheHitIsReadButNotPrefetched) {
  TniHarness::Setup setup = seven_nodes(Prefetch::kStack);
  TniHarness harness(setup);
  harness.add(
      {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(3, 0, 0), traces::cull_step(2), traces::end_step(false)});
  harness.run();
  EXPECT_EQ(trv(harness).stats().prefetch_probes, 0U);
  // The second culled entry follows a pop, with nothing below.
  EXPECT_EQ(trv(harness).stats().pops, 2U);
}

TEST(StackPrefetch, LinesEvictedBeforeTheirUseAreUseless) {
  TniHarness::Setup setup = seven_nodes(Prefetch::kTreelet);
  setup.config.trv.l1.size.bytes = 128;
  setup.config.trv.l1.ways = 1;
  TniHarness harness(setup);
  harness.add(kClimb).run();
  const Trv::Stats stats = trv(harness).stats();
  EXPECT_GE(stats.prefetches, 2U);
  EXPECT_GE(stats.prefetches_useless, stats.prefetches - stats.prefetches_useful - stats.prefetches_late - 2)
      << "two lines stay in the cache";
}

/// A ray visits the root `repeats` more times, which hit, then nodes 1 and 3.
std::unique_ptr<TniHarness> treelet_run(std::uint64_t bytes, std::uint32_t repeats) {
  TniHarness::Setup setup = seven_nodes(Prefetch::kTreelet);
  setup.config.trv.treelet_bytes.bytes = bytes;
  Walk walk(1 + repeats, visit_step(0, 1, 0));
  walk.insert(walk.end(), {visit_step(1, 1, 0), visit_step(3, 0, 0), traces::end_step(false)});
  auto harness = std::make_unique<TniHarness>(setup);
  harness->add(walk).run();
  return harness;
}

TEST(TreeletPrefetch, TheMissOfARootRequestsTheRestOfItsTreelet) {
  constexpr std::uint32_t kRepeats = 20;  // longer than a miss of the map and one of a node
  const auto whole = treelet_run(512, kRepeats);
  EXPECT_EQ(whole->latency(0), kWires + (3 + kRepeats) * kVisit + kMiss) << "lines of nodes 1 and 3 have arrived";
  EXPECT_EQ(whole->lines_requested(), 7U + 1 + 1) << "nodes, the leaf that fits, the map";
  EXPECT_EQ(trv(*whole).stats().prefetches_useful, 2U);
  const auto half = treelet_run(192, kRepeats);  // smaller than the key allows: nodes 0 to 2; 3 is a root
  EXPECT_EQ(half->latency(0), kWires + (3 + kRepeats) * kVisit + 2 * kMiss);
}

TEST(TreeletPrefetch, WaitsForTheEntryAndTheListInTheMap) {
  // The map is one line, which is requested with that of the root. Entry and list are read from it.
  const auto whole = treelet_run(512, 0);
  EXPECT_EQ(trv(*whole).stats().map_reads, 2U);
  EXPECT_EQ(trv(*whole).stats().map_misses, 1U);
  EXPECT_GT(whole->latency(0), kWires + 3 * kVisit + kMiss) << "nodes 1 and 3 are requested when the map has arrived";
  EXPECT_LT(whole->latency(0), kWires + 3 * kVisit + 3 * kMiss);
  // Node 3 is a root of its own, and so are others that the ray does not visit.
  const auto half = treelet_run(192, 20);
  EXPECT_EQ(trv(*half).stats().map_reads, 4U);
  EXPECT_EQ(trv(*half).stats().map_misses, 1U);
}

TEST(Treelets, AreConnectedAndNotLargerThanTheirLimit) {
  constexpr std::uint32_t kNodes = 63;
  std::vector<traces::NodeRecord> links(kNodes);
  for (std::uint32_t node = 0; node < kNodes; ++node) {
    for (std::uint32_t c = 0; c < 2; ++c) {
      const std::uint32_t child = 2 * node + 1 + c;
      links[node].child[c] = child < kNodes ? child : traces::leaf_link(child, 1);
    }
  }
  TreeInMemory tree;
  tree.links = links;
  const Treelets treelets(tree, {}, 512, 4096);
  EXPECT_EQ(treelets.treelet_of(7), 0U) << "the eighth node breadth first";
  EXPECT_EQ(treelets.treelet_with_root(8), treelets.treelet_of(8)) << "the ninth does not fit";
  std::vector<std::uint32_t> nodes(treelets.count());
  std::uint64_t words = kNodes;
  for (std::uint32_t node = 0; node < kNodes; ++node) {
    const std::uint32_t treelet = treelets.treelet_of(node);
    nodes.at(treelet) += 1;
    const bool is_root = treelets.treelet_with_root(node) == treelet;
    EXPECT_TRUE(is_root || treelets.treelet_of((node - 1) / 2) == treelet) << node;
  }
  for (std::uint32_t treelet = 0; treelet < treelets.count(); ++treelet) {
    const auto below = treelets.links_below_root(treelet);
    EXPECT_EQ(std::ranges::count_if(below, std::not_fn(traces::is_leaf)) + 1, nodes[treelet]);
    EXPECT_LE(nodes[treelet], 8U);
    EXPECT_EQ(treelets.first_line_of_list(treelet), line_of(4096 + 4 * words));
    words += below.size() + 1;
    EXPECT_EQ(treelets.last_line_of_list(treelet), line_of(4096 + 4 * words - 4));
  }
  EXPECT_EQ(treelets.map_bytes(), 4 * words);
  EXPECT_EQ(treelets.line_of_entry(17), 4096U + 64);
}

TEST(Treelets, CountTheLinesOfTheirLeaves) {
  std::vector<traces::NodeRecord> links(2);
  links[0].child[0] = 1;
  links[0].child[1] = traces::leaf_link(0, 4);  // 192 bytes: three lines
  links[1].child[0] = traces::leaf_link(4, 4);  // three more
  links[1].child[1] = traces::leaf_link(8, 1);  // one
  TreeInMemory tree;
  tree.links = links;
  const Treelets treelets(tree, {.base = 1 << 20}, 512);  // two nodes and two leaves of three lines
  EXPECT_EQ(treelets.count(), 1U);
  EXPECT_EQ(std::vector(treelets.links_below_root(0).begin(), treelets.links_below_root(0).end()),
            (std::vector<std::uint32_t>{1, links[0].child[1], links[1].child[0]}));
}

}  // namespace
}  // namespace hw
