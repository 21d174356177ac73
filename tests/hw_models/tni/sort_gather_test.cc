#include <vector>

#include <gtest/gtest.h>

#include "hw_models/tni/sort_window.h"
#include "tests/hw_models/tni/random_load.h"
#include "traces/ray_key.h"

// Tests of the order in which rays are sent to traversal units, and of rays served in groups.

namespace hw {
namespace {

using test::kMiss;
using test::kVisit;
using test::kWires;
using test::one_trv;
using test::RandomLoad;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::end_step;
using traces::visit_step;

RayJob job(std::uint32_t id, std::uint32_t key) { return {nullptr, id, kNoTile, key}; }

TEST(SortWindow, SendsKeysUpwardsFromTheLastOneAndThenFromTheStart) {
  SortWindow window(16, 1000);
  EXPECT_EQ(window.insert_ray(job(0, 5), 0), 0U);
  EXPECT_EQ(window.insert_ray(job(1, 3), 1), 1U) << "one entry moves";
  EXPECT_EQ(window.insert_ray(job(2, 9), 2), 0U);
  EXPECT_EQ(window.insert_ray(job(3, 3), 3), 2U) << "equal keys keep their order";
  EXPECT_EQ(window.remove_next(4).job.id, 1U);
  EXPECT_EQ(window.remove_next(5).job.id, 3U);
  const SortWindow::Sent third = window.remove_next(6);
  EXPECT_EQ(third.job.id, 0U);
  EXPECT_EQ(third.moved, 1U);
  window.insert_ray(job(4, 4), 7);
  window.insert_ray(job(5, 7), 8);
  EXPECT_EQ(window.remove_next(9).job.id, 5U) << "keys of at least 5 come first";
  EXPECT_EQ(window.remove_next(10).job.id, 2U);
  EXPECT_EQ(window.remove_next(11).job.id, 4U);
  EXPECT_TRUE(window.is_empty());
}

TEST(SortWindow, SendsTheOldestRayFirstWhenItHasWaitedForTheTimeout) {
  SortWindow window(16, 10);
  window.insert_ray(job(0, 1), 0);
  window.insert_ray(job(1, 5), 1);
  window.insert_ray(job(2, 6), 2);
  EXPECT_EQ(window.remove_next(3).job.id, 0U);
  window.insert_ray(job(3, 2), 3);
  const SortWindow::Sent late = window.remove_next(11);
  EXPECT_EQ(late.job.id, 1U);
  EXPECT_TRUE(late.timed_out);
  const SortWindow::Sent next = window.remove_next(11);
  EXPECT_EQ(next.job.id, 3U) << "keys are still searched from 1 on";
  EXPECT_FALSE(next.timed_out);
}

TniHarness::Setup sorting(std::uint32_t timeout) {
  TniHarness::Setup setup = one_trv();
  setup.config.dispatcher = {RaySort::kOriginOctant, 16, timeout};
  return setup;
}

TEST(Sort, ALoneRayTakesOneCycleMore) {
  TniHarness harness(sorting(1000));
  harness.add({visit_step(0, 0, 0), end_step(false)}).run();
  EXPECT_EQ(harness.latency(0), kWires + kVisit + kMiss + 1);
}

TEST(Sort, RaysLeaveInTheOrderOfTheirKeysUnlessTheyWaitTooLong) {
  const auto order = [](std::uint32_t timeout) {
    TniHarness::Setup setup = sorting(timeout);
    setup.config.trv.rays = 1;
    TniHarness harness(setup);
    for (std::uint32_t ray = 0; ray < 6; ++ray) harness.add({visit_step(ray, 0, 0), end_step(false)}, 1, 5 - ray);
    harness.run();
    EXPECT_EQ(harness.tni().dispatcher().stats().window_writes, 6U);
    EXPECT_EQ(harness.tni().dispatcher().stats().window_reads, 6U);
    return harness.arrived();
  };
  EXPECT_EQ(order(10'000), (std::vector<std::uint32_t>{0, 5, 4, 3, 2, 1}));
  EXPECT_EQ(order(1), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
}

TEST(RayKeys, InterleaveTheCellsOfTheOriginAboveTheOctant) {
  const traces::RayKeyGrid grid({0, 0, 0}, {32, 32, 32});
  const auto key = [&](glm::vec3 origin, glm::vec3 direction) { return grid.key_of({origin, 0, direction}); };
  EXPECT_EQ(key({0.5F, 0.5F, 0.5F}, {1, 1, 1}), 0U);
  EXPECT_EQ(key({0.5F, 0.5F, 0.5F}, {-1, 1, -1}), 5U);
  EXPECT_EQ(key({1.5F, 0.5F, 0.5F}, {1, 1, 1}), 1U << 3);
  EXPECT_EQ(key({0.5F, 3.5F, 0.5F}, {1, 1, 1}), (1U << 1 | 1U << 4) << 3);
  EXPECT_EQ(key({99, 99, 99}, {-1, -1, -1}), (1U << 18) - 1) << "outside: the nearest cell";
  EXPECT_EQ(key({-99, 0, 0}, {1, 1, 1}), 0U);
}

TniHarness::Setup gathering(Gather gather, std::uint32_t width = 8) {
  TniHarness::Setup setup = one_trv();
  setup.config.trv.gather = gather;
  setup.config.trv.gather_width = width;
  return setup;
}

TEST(Gather, AGroupThatWaitsForALineReadsItOnce) {
  const Walk walk = {visit_step(0, 1, 0), visit_step(7, 0, 0), end_step(false)};
  std::vector<std::uint64_t> latencies;
  for (const Gather gather : {Gather::kOff, Gather::kNode}) {
    TniHarness harness(gathering(gather));
    harness.add(walk, 8).run();
    const Trv::Stats stats = trv(harness).stats();
    EXPECT_EQ(stats.visits, 16U);
    latencies.push_back(harness.latency(7));
    if (gather == Gather::kOff) continue;
    // The eight rays arrive one by one and miss one by one; later they are a full group. They reach the second node
    // one by one again, so all but the first find its line requested.
    EXPECT_EQ(stats.l1_hits, 2U);
    EXPECT_EQ(stats.gathered, 14U);
    EXPECT_EQ(stats.full_groups, 2U);
    EXPECT_EQ(stats.l1_misses, 16U);
    EXPECT_EQ(stats.l1_late, 2U) << "both lines were read once, after a miss";
  }
  EXPECT_EQ(latencies[0], latencies[1]) << "the box pipe takes one ray per cycle in both";
}

TEST(Gather, LargerGroupsThanTheWidthReadTheLineAgain) {
  for (const std::uint32_t width : {4U, 6U}) {
    TniHarness harness(gathering(Gather::kNode, width));
    harness.add({visit_step(0, 0, 0), end_step(false)}, 13).run();
    EXPECT_EQ(trv(harness).stats().l1_hits, (13 + width - 1) / width);
    EXPECT_EQ(trv(harness).stats().full_groups, 13 / width);
  }
}

TEST(Gather, EachComparisonOfTwoLinesIsCounted) {
  TniHarness harness(gathering(Gather::kNode));
  for (std::uint32_t ray = 0; ray < 12; ++ray) harness.add({visit_step(ray % 3 * 16, 0, 0), end_step(false)});
  const Trv::Stats stats = trv(harness.run()).stats();
  EXPECT_EQ(stats.gathered, 9U);
  // Four rays wait when the first line arrives (3 comparisons), and eight when their group has left: their lines are
  // two groups (7 + 3). The last group is formed again (3).
  EXPECT_EQ(stats.gather_compares, 16U);
}

TEST(Gather, TheLinesOfWaitingRaysAreStored) {
  TniConfig config;
  const std::uint64_t off = config.trv_sram_bytes();
  config.trv.gather = Gather::kNode;
  EXPECT_EQ(config.trv_sram_bytes(), off + 4 * std::uint64_t{config.trv.rays});
}

TEST(Gather, AllWorkIsDoneAndFewerProbesAreMade) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const RandomLoad load(seed);
    TniHarness::Setup setup = one_trv();
    load.give(setup);
    setup.config.trv.stack = StackScheme::kFull;
    const auto stats = [&](Gather gather) {
      setup.config.trv.gather = gather;
      TniHarness harness(setup);
      return trv(load.send(harness).run()).stats();
    };
    const Trv::Stats off = stats(Gather::kOff), node = stats(Gather::kNode);
    EXPECT_EQ(off.visits, node.visits);
    EXPECT_EQ(off.pops, node.pops);
    EXPECT_EQ(off.leaves, node.leaves);
    EXPECT_LT(node.l1_accesses, off.l1_accesses);
    EXPECT_EQ(node.l1_hits + node.gathered, node.visits) << "one line per visit";
    EXPECT_LE(node.l1_late, node.l1_hits);
    EXPECT_GE(node.l1_late, node.l1_fills) << "without prefetches, a read that missed first fills a line";
  }
}

TEST(Coherence, NoMechanismIsFasterThanAnL1ThatAlwaysHits) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RandomLoad load(seed);
    TniHarness::Setup setup = one_trv();
    load.give(setup);
    setup.config.trv.rays = 8;
    const auto span = [&](Prefetch prefetch, Gather gather, bool ideal) {
      setup.config.trv.prefetch = prefetch;
      setup.config.trv.gather = gather;
      setup.ideal = {false, ideal};
      TniHarness harness(setup);
      return load.send(harness).run().span();
    };
    const std::uint64_t bound = span(Prefetch::kNone, Gather::kOff, true);
    for (const Prefetch prefetch : {Prefetch::kNone, Prefetch::kStack, Prefetch::kTreelet}) {
      for (const Gather gather : {Gather::kOff, Gather::kNode}) {
        EXPECT_GE(span(prefetch, gather, false), bound) << seed;
      }
    }
  }
}

}  // namespace
}  // namespace hw
