#include <gtest/gtest.h>

#include "tests/hw_models/tni/random_load.h"

// Tests of the four ways to handle a cache miss (tni.miss_handling), with cycle counts computed by hand.

namespace hw {
namespace {

using test::kMiss, test::kPeriod, test::kVisit;
using test::kWires;
using test::RandomLoad;
using test::TniHarness;
using test::trv;
using test::Walk;
using traces::end_step;
using traces::visit_step;

constexpr MissHandling kAll[] = {MissHandling::kReorder, MissHandling::kBypass, MissHandling::kRau,
                                 MissHandling::kBlocking};

TniHarness::Setup one_trv(MissHandling handling) {
  TniHarness::Setup s = test::one_trv();
  s.config.miss_handling = handling;
  return s;
}

Walk one_node(std::uint32_t node) { return {visit_step(node, 0, 0), end_step(false)}; }

TEST(MissHandling, ASingleRayWaitsEquallyForEachLineUnlessItLoops) {
  for (const MissHandling handling : kAll) {
    TniHarness harness(one_trv(handling));
    harness.add({visit_step(0, 1, 0), visit_step(1, 1, 0), visit_step(2, 0, 0), end_step(false)}).run();
    const bool loops = handling == MissHandling::kBypass;
    const std::uint64_t wait =
        loops ? 4 * kVisit : kMiss;  // loops of 14 cycles through the pipe until the line arrives
    EXPECT_EQ(harness.latency(0), kWires + 3 * (kVisit + wait)) << static_cast<int>(handling);
    EXPECT_EQ(trv(harness).stats().bypass_passes, loops ? 3U * 4U : 0U);
    EXPECT_EQ(trv(harness).stats().l1_miss_cycles, 3 * kMiss);
  }
}

TEST(MissHandling, WithoutMissesAllTakeTheSameCycles) {
  const RandomLoad load(1);
  std::vector<sim::Time> ends;
  for (const MissHandling handling : kAll) {
    TniHarness::Setup setup = test::random_setup(7);
    load.give(setup);
    setup.config.miss_handling = handling;
    setup.ideal = {false, true};
    TniHarness harness(setup);
    ends.push_back(load.send(harness).run().end_time());
    EXPECT_EQ(harness.lines_requested(), 0U);
  }
  EXPECT_EQ(std::ranges::count(ends, ends.front()), 4);
}

TEST(MissHandling, BlockingHasOneOutstandingLineAndTheNextRayProbesAfterIt) {
  TniHarness harness(one_trv(MissHandling::kBlocking));
  for (std::uint32_t i = 0; i < 10; ++i) harness.add(one_node(i));
  harness.run();
  for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(harness.latency(i), kWires + kVisit + kMiss + i * kMiss) << i;
}

TEST(MissHandling, ReorderOverlapsTheMissesOfIndependentRays) {
  TniHarness harness(one_trv(MissHandling::kReorder));
  for (std::uint32_t i = 0; i < 8; ++i) harness.add(one_node(i));
  harness.run();
  for (std::uint32_t i = 0; i < 8; ++i) EXPECT_EQ(harness.latency(i), kWires + kVisit + kMiss) << i;
}

TEST(MissHandling, RaysLoopUntilTheirLineArrivesAndReadItWithTheNextProbe) {
  // 14 rays for one line loop through the pipe and fill it until the line arrives at cycle 51.
  TniHarness harness(one_trv(MissHandling::kBypass));
  harness.add(one_node(0), 14).run();
  EXPECT_EQ(trv(harness).stats().bypass_passes,
            14U * 4U - 5U);  // rays 9 to 13 start late enough to miss only three times
  EXPECT_EQ(trv(harness).stats().l1_accesses, trv(harness).stats().bypass_passes + 14);
}

TEST(MissHandling, AFullTableStallsTheFetchStageUntilARowIsFree) {
  TniHarness::Setup setup = one_trv(MissHandling::kRau);
  setup.config.rau = {1, 4};
  TniHarness one(setup);
  one.add(one_node(0)).add(one_node(1)).run();
  EXPECT_EQ(one.latency(0), kWires + kVisit + kMiss);
  EXPECT_EQ(one.latency(1), kWires + kVisit + kMiss + kMiss);
  EXPECT_EQ(trv(one).stats().rau_full, 1U);
  EXPECT_EQ(trv(one).activity().spent(Trv::CycleReason::kRauFull), (kMiss - 1) * kPeriod);

  setup.config.rau = {2, 4};
  TniHarness two(setup);
  two.add(one_node(0)).add(one_node(1)).run();
  EXPECT_EQ(two.latency(1), kWires + kVisit + kMiss);
  EXPECT_EQ(trv(two).activity().spent(Trv::CycleReason::kRauFull), 0U);
}

TEST(MissHandling, AFullRowStallsTheFetchStageUntilItsLineArrives) {
  TniHarness::Setup setup = one_trv(MissHandling::kRau);
  setup.config.rau = {16, 1};
  TniHarness harness(setup);
  harness.add(one_node(0), 2).add(one_node(1)).run();
  EXPECT_EQ(harness.latency(0), kWires + kVisit + kMiss);
  EXPECT_EQ(harness.latency(1), kWires + kVisit + kMiss);  // probes again right after the first ray of its row
  EXPECT_EQ(harness.latency(2), kWires + kVisit + kMiss + kMiss);
  EXPECT_EQ(trv(harness).stats().rau_full, 1U);
  EXPECT_EQ(trv(harness).stats().l1_hits, 1U);
  EXPECT_EQ(trv(harness).stats().rau_reads, 2U);
}

TEST(MissHandling, RaysOfARowResumeWithoutAnotherProbe) {
  TniHarness harness(one_trv(MissHandling::kRau));
  harness.add(one_node(0), 4).run();
  EXPECT_EQ(trv(harness).stats().l1_accesses, 4U);
  EXPECT_EQ(trv(harness).stats().rau_writes, 4U);
  EXPECT_EQ(trv(harness).stats().rau_reads, 4U);
  EXPECT_EQ(trv(harness).stats().rau_fills, 1U);
}

TEST(MissHandling, ALineIsLateIfTheFirstProbeForItMissedHoweverManyFollow) {
  for (const MissHandling handling : kAll) {
    TniHarness harness(one_trv(handling));
    harness.add(one_node(0), 4).run();
    // If a ray that missed blocks the fetch stage, later rays probe when its line has arrived.
    EXPECT_EQ(trv(harness).stats().l1_late, handling == MissHandling::kBlocking ? 1U : 4U)
        << static_cast<int>(handling);
    EXPECT_EQ(trv(harness).stats().l1_hits + trv(harness).stats().rau_reads, 4U);
  }
}

TEST(MissHandling, BlockingIsNeverFasterThanReorderIfLinesAreScarce) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const RandomLoad load(seed);
    const auto cycles = [&](MissHandling handling) {
      TniHarness::Setup setup;
      load.give(setup);
      setup.config.miss_handling = handling;
      setup.config.trv.l1.size.bytes = setup.config.ist.l1.size.bytes = 1024;
      TniHarness harness(setup);
      return load.send(harness).run().span();
    };
    EXPECT_GT(cycles(MissHandling::kBlocking), cycles(MissHandling::kReorder)) << seed;
  }
}

TEST(MissHandling, CachesOfOneLineFinishUnderEachOfThem) {
  const RandomLoad load(3);
  for (const MissHandling handling : kAll) {
    for (const std::uint32_t registers : {1U, 2U, 3U}) {
      TniHarness::Setup setup;
      load.give(setup);
      setup.config.miss_handling = handling;
      setup.config.rau = {1, 1};
      setup.config.trv.prefetch = Prefetch::kSibling;
      for (CacheConfig* l1 : {&setup.config.trv.l1, &setup.config.ist.l1}) {
        l1->size.bytes = 64;
        l1->ways = 1;
        l1->mshrs = registers;
      }
      TniHarness harness(setup);
      load.send(harness).run();
      EXPECT_EQ(harness.arrived().size(), load.walks.size());
    }
  }
}

}  // namespace
}  // namespace hw
