#include <gtest/gtest.h>

#include "tests/hw_models/tni/random_load.h"

// Tests of how a recorded traversal is expanded: box testers, tree records, stacks, prefetching, dispatch, ideal units.

namespace hw {
namespace {

using test::alone;
using test::kMiss, test::kPeriod, test::kPop, test::kVisit;
using test::kWires;
using test::one_trv;
using test::RandomLoad;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::end_step;
using traces::leaf_step;
using traces::visit_step;

const Walk kTwoDown = {visit_step(0, 1, 0), visit_step(1, 0, 0), end_step(false)};
const Walk kPopped = {visit_step(0, 3, 0), visit_step(1, 0, 0), visit_step(2, 0, 0), end_step(false)};

TEST(BoxTesters, ASingleTesterTakesTwoPassesPerVisit) {
  TniHarness::Setup setup = one_trv();
  EXPECT_EQ(alone(setup, kPopped), 3 * kVisit + kPop);
  setup.config.trv.box_testers = 1;
  EXPECT_EQ(alone(setup, kTwoDown), 2 * 2 * kVisit);
  EXPECT_EQ(alone(setup, kPopped), 3 * 2 * kVisit + kPop);
}

TEST(BoxTesters, WithASingleTesterPassesPopsAndLeavesShareOnePipe) {
  constexpr std::uint32_t kRays = 1000;
  const auto run = [&](std::uint32_t testers, const Walk& walk, auto&& check) {
    TniHarness::Setup setup = one_trv();
    setup.config.trv.rays = 64;
    setup.config.trv.box_testers = testers;
    setup.ideal.l1 = true;
    TniHarness harness(setup);
    harness.add(walk, kRays).run();
    check(harness);
  };
  const Walk leaf = {visit_step(0, 1, 0), leaf_step(0, 2), 0x11, end_step(false)};
  // The ray: three visits and a pop.
  run(1, kPopped, [&](const TniHarness& harness) {
    EXPECT_NEAR(static_cast<double>(harness.span()), 7.0 * kRays, 200);
    EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kSerial), kRays * kPeriod);
    EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kVisiting), 6 * kRays * kPeriod);
  });
  run(2, kPopped, [&](const TniHarness& harness) {
    EXPECT_NEAR(static_cast<double>(harness.span()), 3.0 * kRays, 200);
    EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kSerial), 0U);
  });
  // The ray: one visit, then a leaf of two triangles. The second one straddles two lines.
  run(1, leaf, [&](const TniHarness& harness) {
    EXPECT_NEAR(static_cast<double>(harness.span()), 4.0 * kRays, 200);
    EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kSerial), 2 * kRays * kPeriod);
  });
  run(2, leaf, [&](const TniHarness& harness) { EXPECT_NEAR(static_cast<double>(harness.span()), 3.0 * kRays, 200); });
}

TEST(BoxTesters, InOnePipeABlockingMissStallsPopsToo) {
  // Ray 1 needs its pop after ray 0 has stalled the fetch stage.
  const auto latency = [](std::uint32_t testers) {
    TniHarness::Setup setup = one_trv();
    setup.config.trv.box_testers = testers;
    setup.config.miss_handling = MissHandling::kBlocking;
    setup.memory_latency = 500;
    TniHarness harness(setup);
    harness.add({visit_step(0, 1, 0), visit_step(0, 1, 0), visit_step(100, 0, 0), end_step(false)});
    harness.add({visit_step(0, 3, 0), visit_step(0, 0, 0), visit_step(0, 0, 0), end_step(false)});
    return harness.run().latency(1);
  };
  constexpr std::uint64_t kMemory = 501;
  EXPECT_EQ(latency(1), kWires + kMemory + 4 * kVisit + kMemory + kPop + 2 * kVisit);
  EXPECT_EQ(latency(2), kWires + kMemory + 2 * kVisit + kMemory + kVisit);
}

TEST(TreeRecords, AVisitReadsEachLineOfItsRecordsOnce) {
  const std::vector<std::array<std::uint32_t, 2>> boxes = {{1, 0}, {2, 3}, {4, 9}};
  const auto lines = [&](std::uint32_t bytes, bool single, std::uint32_t node, std::uint32_t testers,
                         std::uint32_t child) {
    TreeInMemory tree{.nodes = 1024, .node_bytes = bytes, .parents = {}, .single_boxes = {}, .links = {}};
    if (single) tree.single_boxes = boxes;
    std::vector<Addr> all;
    for (bool more = true; more;) {
      const TreeInMemory::Line line = tree.line_of_visit(node, testers, child, static_cast<std::uint32_t>(all.size()));
      all.push_back(line.line - 1024);
      more = !line.last;
    }
    return all;
  };
  using Lines = std::vector<Addr>;
  EXPECT_EQ(lines(64, false, 5, 2, 0), Lines{320});
  EXPECT_EQ(lines(64, false, 5, 1, 1), Lines{320});
  EXPECT_EQ(lines(48, false, 1, 2, 0), (Lines{0, 64}));
  EXPECT_EQ(lines(32, true, 0, 2, 0), Lines{0});
  EXPECT_EQ(lines(32, true, 2, 2, 0), (Lines{128, 256}));
  EXPECT_EQ(lines(32, true, 2, 1, 1), Lines{256});
  EXPECT_EQ(lines(40, true, 0, 2, 0), (Lines{0, 64}));               // 40..79, 0..39
  EXPECT_EQ(lines(40, true, 2, 2, 0), (Lines{128, 192, 320, 384}));  // 160..199, 360..399
}

TEST(TreeRecords, EachFurtherLineTakesACycleOfTheFetchStage) {
  TniHarness::Setup setup = one_trv();
  setup.node_bytes = 48;
  EXPECT_EQ(alone(setup, kTwoDown), 2 * kVisit + 1);  // node 0 at 0..47, node 1 at 48..95
  setup.node_bytes = 32;
  setup.single_boxes = {{0, 1}, {2, 5}};
  EXPECT_EQ(alone(setup, kTwoDown), 2 * kVisit + 1);
  setup.config.trv.box_testers = 1;
  EXPECT_EQ(alone(setup, kTwoDown), 4 * kVisit);
}

TEST(TreeRecords, TrianglesOf36BytesReadTheLinesTheyOccupy) {
  const auto accesses = [](std::uint32_t bytes) {
    TniHarness::Setup setup = one_trv();
    setup.triangle_bytes = bytes;
    setup.ideal.l1 = true;
    TniHarness harness(setup);
    harness.add({visit_step(0, 1, 0), leaf_step(0, 3), 0x111, end_step(false)}).run();
    return harness.tni().ist_of(0).stats().l1_accesses;
  };
  EXPECT_EQ(accesses(36), 1U + 2U + 1U);  // from 0, 36 (across 64) and 72 on
  EXPECT_EQ(accesses(48), 1U + 2U + 2U);  // from 0, 48 (across 64) and 96 (across 128) on
}

TEST(TreeRecords, HybridBoxesAreCountedSeparately) {
  TniHarness::Setup setup = one_trv();
  setup.hybrid = true;
  TniHarness harness(setup);
  harness.add(kTwoDown).run();
  EXPECT_EQ(trv(harness).stats().hybrid_box_tests, 4U);
  EXPECT_EQ(trv(harness).stats().box_tests, 0U);
}

/// Traversal along the chain 0 -> 1 -> 2 -> 3 that pushes at each node. No entry is culled: all four far children are
/// popped.
const Walk kChain = {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(2, 3, 0), visit_step(3, 3, 0),
                     visit_step(4, 0, 0), visit_step(5, 0, 0), visit_step(6, 0, 0), visit_step(7, 0, 0),
                     visit_step(8, 0, 0), end_step(false)};

TniHarness::Setup trail(std::uint32_t entries) {
  TniHarness::Setup setup = one_trv();
  setup.parents = {0, 0, 1, 2, 3, 3, 2, 1, 0};
  setup.config.trv.stack = StackScheme::kRestartTrail;
  setup.config.trv.stack_entries = entries;
  return setup;
}

TEST(RestartTrail, APopFromTheEmptyShortStackDescendsFromTheRootToTheEntry) {
  TniHarness harness(trail(2));
  harness.add(kChain).run();
  const Trv::Stats& s = trv(harness).stats();
  // The entries of nodes 3 and 2 are popped. That of 1 was dropped: a restart visits 0, which pushes its entry again,
  // and 1, where the trail continues.
  EXPECT_EQ(s.restarts, 1U);
  EXPECT_EQ(s.restarted_visits, 2U);
  EXPECT_EQ(s.pops, 3U);
  EXPECT_EQ(s.pushes, 4U + 1U);
  EXPECT_EQ(alone(trail(2), kChain), (9 + 2) * kVisit + 4 * kPop);
}

TEST(RestartTrail, WithoutAStackEachPopDescendsFromTheRoot) {
  TniHarness harness(trail(0));
  harness.add(kChain).run();
  const Trv::Stats& s = trv(harness).stats();
  EXPECT_EQ(s.restarts, 4U);
  EXPECT_EQ(s.restarted_visits, 4U + 3U + 2U + 1U);
  EXPECT_EQ(s.pushes, 0U);
  EXPECT_EQ(s.pops, 0U);
  EXPECT_EQ(alone(trail(0), kChain), (9 + 10) * kVisit + 4 * kPop);
}

TEST(RestartTrail, AnEntryThatWasPoppedIsNotFoundAgain) {
  // Node 1 hits both children, its near child 2 neither. Its far child 3 is popped, and hits both. After 4 the entry of
  // 3 is popped, after 5 that of 0: restarts of three nodes (0, 1, 3) and of one.
  const Walk walk = {visit_step(0, 3, 0), visit_step(1, 3, 0), visit_step(2, 0, 0), visit_step(3, 3, 0),
                     visit_step(4, 0, 0), visit_step(5, 0, 0), visit_step(6, 0, 0), end_step(false)};
  TniHarness::Setup setup = trail(0);
  setup.parents = {0, 0, 1, 1, 3, 3, 0};
  TniHarness harness(setup);
  harness.add(walk).run();
  EXPECT_EQ(trv(harness).stats().restarts, 3U);
  EXPECT_EQ(trv(harness).stats().restarted_visits, 2U + 3U + 1U);
}

TEST(Prefetch, TheFarChildArrivesDuringTheWaitForTheNearOne) {
  TniHarness::Setup setup = one_trv();
  setup.links.resize(3);
  setup.links[0].child[0] = 1;
  setup.links[0].child[1] = 2;
  const auto latency = [&](Prefetch prefetch, std::uint32_t registers) {
    setup.config.trv.prefetch = prefetch;
    setup.config.trv.l1.mshrs = registers;
    TniHarness harness(setup);
    harness.add(kPopped).run();
    EXPECT_EQ(harness.lines_requested(), 3U);
    return harness.latency(0);
  };
  const std::uint64_t none = kWires + 3 * (kMiss + kVisit) + kPop;
  EXPECT_EQ(latency(Prefetch::kNone, 8), none);
  EXPECT_EQ(latency(Prefetch::kSibling, 8), none - kMiss);
  // The near child takes an MSHR, and the far one would take the second; a third must stay free.
  EXPECT_EQ(latency(Prefetch::kSibling, 3), none - kMiss);
  EXPECT_EQ(latency(Prefetch::kSibling, 2), none);
  setup.links[0].child[1] = traces::leaf_link(0, 1);
  EXPECT_EQ(latency(Prefetch::kSibling, 8), none);
}

TEST(Dispatch, RoundRobinServesTraversalUnitsInTurnAndSkipsFullOnes) {
  TniHarness::Setup setup = one_trv();
  setup.config.trvs = 3;
  setup.config.dispatch = Dispatch::kRoundRobin;
  setup.config.trv.rays = 64;
  Walk long_walk(200, visit_step(0, 1, 0));
  long_walk.push_back(end_step(false));
  const auto shares = [&] {
    TniHarness harness(setup);
    harness.add(long_walk).add(kTwoDown, 8).run();
    std::vector<std::uint64_t> rays;
    for (const Trv* unit : harness.tni().trvs()) rays.push_back(unit->stats().rays_in);
    return rays;
  };
  EXPECT_EQ(shares(), (std::vector<std::uint64_t>{3, 3, 3}));
  setup.config.trv.rays = 1;
  EXPECT_EQ(shares(), (std::vector<std::uint64_t>{1, 4, 4}));
}

TEST(Ideal, EveryOperationOfAnIdealUnitTakesOneCycleAndAnyNumberRunAtOnce) {
  TniHarness::Setup setup = one_trv();
  setup.ideal = {true, true};
  TniHarness harness(setup);
  harness.add(kPopped, 40).run();
  for (std::size_t ray = 0; ray < 40; ++ray) EXPECT_EQ(harness.latency(ray), kWires + 3 + 1) << ray;

  TniHarness leaf(setup);
  leaf.add({visit_step(0, 1, 0), leaf_step(0, 8), 0x33333333, end_step(false)}, 40).run();
  for (std::size_t ray = 0; ray < 40; ++ray) EXPECT_EQ(leaf.latency(ray), kWires + 1 + 1 + 1 + 1) << ray;
}

TEST(Ideal, AnIdealUnitStillWaitsForItsLines) {
  TniHarness::Setup setup = one_trv();
  setup.ideal = {true, false};
  TniHarness harness(setup);
  harness.add(kTwoDown).run();
  EXPECT_EQ(harness.latency(0), kWires + 2 * (kMiss + 1));
}

TEST(Ideal, ACycleWhoseVisitsAllMissWaitsForLines) {
  TniHarness::Setup setup = one_trv();
  setup.ideal = {true, false};
  TniHarness harness(setup);
  for (const std::uint32_t node : {100U, 200U}) {
    harness.add({visit_step(0, 1, 0), visit_step(node, 0, 0), end_step(false)});
  }
  harness.run();
  // Both visit node 0 in one cycle and miss in the next; lines arrive one by one.
  EXPECT_EQ(trv(harness).activity().spent(Trv::CycleReason::kVisiting), 3 * kPeriod);
}

TEST(Ideal, AnIdealUnitIsNeverSlower) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const RandomLoad load(seed);
    TniHarness::Setup setup = test::random_setup(seed);
    load.give(setup);
    const auto span = [&](bool ideal) {
      setup.ideal = {ideal, true};
      TniHarness harness(setup);
      return load.send(harness).run().span();
    };
    EXPECT_LE(span(true), span(false)) << seed;
  }
}

}  // namespace
}  // namespace hw
