#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;
using test::trace_and_shade;
using traces::Access;

constexpr std::uint64_t kResident = SrpHarness::kResident, kLine = SrpHarness::kLine, kLoad = SrpHarness::kLoad;

traces::TileWork one_launch(std::uint32_t items, std::uint32_t tile = 0) {
  TileBuilder work(tile);
  work.launch(kA, items);
  return work.build();
}

TEST(Srp, ALaunchOfNItemsTakesSwitchDepthAndAnIntervalForEachFurtherItem) {
  for (const SrpHarness::Kernel kernel : {SrpHarness::Kernel{1, 10}, {3, 20}, {17, 230}}) {
    for (const std::uint32_t n : {1U, 2U, 16U, 256U}) {
      SrpHarness harness({}, {kernel});
      harness.add(one_launch(n)).run();
      const std::uint64_t expected = SrpHarness::cold(kernel.ii) + kernel.depth + (n - 1) * kernel.ii;
      EXPECT_EQ(harness.cycles(kA), expected);
      EXPECT_EQ(harness.done_at(0), expected) << "the tile leaves with its last item";
      EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching), SrpHarness::cold(kernel.ii));
    }
  }
}

TEST(Srp, ASecondChunkOfTheSameKernelPaysPrologueAndDrainButNoSwitch) {
  SrpHarness::Setup setup;
  setup.config.chunk = 10;
  SrpHarness harness(setup, {{3, 20}});
  harness.add(one_launch(25)).run();
  EXPECT_EQ(harness.cycles(kA), SrpHarness::cold(3) + (20 + 9 * 3) + (20 + 9 * 3) + (20 + 4 * 3));
  EXPECT_EQ(harness.done_at(0), harness.cycles(kA)) << "one chunk begins as the other ends";
  EXPECT_EQ(harness.srp().stats().switches, 1U);
  EXPECT_EQ(harness.srp().stats().chunks, 3U);
}

TEST(Srp, AnotherKernelPaysItsSwitch) {
  SrpHarness harness({}, {{1, 10}, {2, 30}});
  TileBuilder work;
  const auto a = work.launch(kA, 16);
  work.launch(kA, 16, {TileBuilder::all(work.launch(kB, 16, {TileBuilder::all(a)}))});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.srp().stats().switches, 3U);
  EXPECT_EQ(harness.done_at(0), SrpHarness::cold(1) + SrpHarness::cold(2) + kResident + 2 * (10 + 15) + 30 + 15 * 2);
}

TEST(Srp, AMissStallsByItsTimeBeyondTheLoadsLatency) {
  for (const std::uint32_t latency : {1U, 10U, 62U, 63U, 64U, 100U, 500U}) {
    SrpHarness::Setup setup;
    setup.memory_latency = latency;
    SrpHarness harness(setup, {{4, 90}});
    TileBuilder work;
    work.launch(kA, {{Access::attributes(0)}, {Access::attributes(0)}, {Access::attributes(0)}});
    harness.add(work.build()).run();
    const std::uint64_t arrives = 1 + latency;  // the link to memory, then memory
    const std::uint64_t stall = arrives - std::min(arrives, kLoad);
    EXPECT_EQ(harness.cycles(kA), SrpHarness::cold(4) + 90 + 2 * 4 + stall) << latency;
    EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), stall) << latency;
    EXPECT_EQ(harness.srp().stats().cache_fills, 1U);
  }
}

TEST(Srp, ALongerLoadQueueHidesEquallyMoreOfAMiss) {
  for (const std::uint32_t queue : {12U, 36U, 60U}) {
    SrpHarness::Setup setup;
    setup.config.latency.load_queue = queue;
    SrpHarness harness(setup, {{4, 90}});
    TileBuilder work;
    work.launch(kA, {{Access::attributes(0)}, {}, {Access::attributes(1)}});
    harness.add(work.build()).run();
    // The second item requests its line before the first one stalls, so its line arrives during that stall.
    EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), kLine - (4 + queue)) << queue;
  }
}

TEST(Srp, MissesOfConsecutiveItemsOverlap) {
  SrpHarness harness({}, {{1, 90}});
  TileBuilder work;
  work.launch(kA, {{Access::attributes(0)}, {Access::attributes(1)}, {Access::attributes(2)}, {Access::attributes(3)}});
  harness.add(work.build()).run();
  // All four lines are requested, one per cycle, before the first is needed. They arrive one per cycle.
  EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), kLine - kLoad);
}

TEST(Srp, ACachedLineStallsNothing) {
  SrpHarness harness({}, {{4, 90}});
  TileBuilder work;
  const auto first = work.launch(kA, {{Access::attributes(7)}, {Access::material(2)}});
  work.launch(kA, {{Access::material(2)}, {Access::attributes(7)}}, {TileBuilder::all(first)});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.srp().stats().cache_accesses, 4U);
  EXPECT_EQ(harness.srp().stats().cache_hits, 2U);
  const std::uint64_t first_launch = SrpHarness::cold(4) + 90 + 4 + (kLine - kLoad);
  EXPECT_EQ(harness.cycles(kA), first_launch + 90 + 4);
}

TEST(Srp, WithoutAFreeMshrTheArrayStallsAtOnce) {
  SrpHarness::Setup setup;
  setup.config.data_cache.mshrs = 1;
  SrpHarness harness(setup, {{4, 90}});
  TileBuilder work;
  work.launch(kA, {{Access::attributes(0), Access::attributes(1)}});
  harness.add(work.build()).run();
  // The second line is requested only after the first has arrived, so the item stalls for the rest of its latency.
  EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), kLine + (kLine - kLoad));
  EXPECT_EQ(harness.srp().stats().mshr_full, 1U);
}

TEST(Srp, RaysLeaveAsTheirItemsLeaveTheArray) {
  SrpHarness harness({}, {{5, 30}, {1, 10}});
  harness.add(trace_and_shade(8)).run();
  ASSERT_EQ(harness.rays().size(), 8U);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const std::uint64_t wires = 2;  // the links of the tile and of the ray
    EXPECT_EQ(harness.rays()[i].cycle, wires + SrpHarness::cold(5) + 30 + 5 * i);
    EXPECT_EQ(harness.rays()[i].ray, i);
  }
}

TEST(Srp, RaysLeaveNoFasterThanTheDirectInterfaceTakesThem) {
  SrpHarness::Setup setup;
  setup.ray_interval = 4;
  SrpHarness harness(setup, {{1, 30}, {1, 10}});
  harness.add(trace_and_shade(8)).run();
  ASSERT_EQ(harness.rays().size(), 8U);
  for (std::uint32_t i = 1; i < 8; ++i) EXPECT_EQ(harness.rays()[i].cycle, harness.rays()[i - 1].cycle + 4);
}

TEST(Srp, ShadingBeginsWhenTheLastHitOfItsChunkReturns) {
  SrpHarness harness({}, {{5, 30}, {2, 20}});
  harness.add(trace_and_shade(8)).run();
  const std::uint64_t rays = SrpHarness::cold(5) + 30 + 7 * 5, tni = 1 + 10, shading = SrpHarness::cold(2) + 20 + 7 * 2;
  EXPECT_EQ(harness.done_at(0), rays + tni + shading);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kWaiting), tni);
  EXPECT_EQ(harness.srp().tile_buffer().used_slots(), 0U) << "every slot has been given back";
}

TEST(Srp, ConsumersRunBeforeProducers) {
  SrpHarness::Setup setup;
  setup.config.chunk = 4;
  SrpHarness harness(setup, {{1, 10}, {1, 40}});
  harness.add(trace_and_shade(16)).run();
  // Expected order of chunks: A1 A2, then B1 B2 as soon as their hits have returned, then A3 A4 B3 B4. Running all of A
  // first would switch kernels twice.
  EXPECT_EQ(harness.srp().stats().switches, 4U);
}

TEST(Srp, TheOldestTileGoesFirst) {
  SrpHarness::Setup setup;
  setup.config.chunk = 4;
  SrpHarness harness(setup, {{1, 10}, {1, 10}});
  harness.add(one_launch(40, 0)).add(one_launch(40, 1)).add(one_launch(40, 2)).run();
  const std::uint64_t tile = 10 * (10 + 3);
  for (std::uint32_t t = 0; t < 3; ++t) {
    EXPECT_EQ(harness.tiles_done()[t], t);
    EXPECT_EQ(harness.done_at(t), SrpHarness::cold(1) + (t + 1) * tile);
  }
}

TEST(Srp, WhileATilesRaysAreOutTheNextTileRuns) {
  SrpHarness::Setup setup;
  setup.tni_latency = 900;
  SrpHarness harness(setup, {{1, 50}, {1, 50}});
  harness.add(trace_and_shade(16, 0)).add(trace_and_shade(16, 1)).run();
  const std::uint64_t loop = 50 + 15;
  EXPECT_EQ(harness.done_at(0), SrpHarness::cold(1) + loop + 901 + SrpHarness::cold(1) + loop);
  EXPECT_EQ(harness.done_at(1), harness.done_at(0) + loop) << "its hits were back while the first was shaded";
}

}  // namespace
}  // namespace hw
