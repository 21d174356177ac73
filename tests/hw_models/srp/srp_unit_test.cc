#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/srp/srp_config.h"
#include "hw_models/srp/srp_stats.h"
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

std::string complaints(const ArrayConfig& array) {
  std::string keys;
  array.check([&](const std::string& key, const std::string&) { keys += key + ' '; });
  return keys;
}

TEST(SrpConfig, AUnitCannotHaveTwoMultipliersOrDividers) {
  EXPECT_EQ(complaints({}), "");
  EXPECT_EQ(complaints({.rows = 4, .columns = 2}), "mul_units ");
  EXPECT_EQ(complaints({.rows = 1, .columns = 2, .mul_units = 2, .div_sqrt_units = 3}), "div_sqrt_units ");
  EXPECT_EQ(complaints({.rows = 1, .columns = 2, .mul_units = 2, .div_sqrt_units = 2}), "");
}

TEST(SrpConfig, ALoadTakesAtMostSixtyFourCycles) {
  const auto complaints_of = [](const OpLatencyConfig& latency) {
    std::string keys;
    latency.check([&](const std::string& key, const std::string&) { keys += key; });
    return keys;
  };
  EXPECT_EQ(complaints_of({.cached_load = 4, .load_queue = 60}), "");
  EXPECT_EQ(complaints_of({.cached_load = 5, .load_queue = 60}), "load_queue");
}

TEST(SrpConfig, ItsStorageExcludesTheTileBuffer) { EXPECT_EQ(SrpConfig{}.sram_bytes(), (16U + 64U + 36U) * 1024U); }

TEST(KernelUse, OfTwoCoresIsTheSumOfBoth) {
  KernelUse sum{1, 20, 3, 400, 50};
  sum += KernelUse{2, 30, 4, 500, 60};
  EXPECT_EQ(sum.launches, 3U);
  EXPECT_EQ(sum.items, 50U);
  EXPECT_EQ(sum.idle, 7U);
  EXPECT_EQ(sum.cycles, 900U);
  EXPECT_EQ(sum.starved, 110U);
}

SrpHarness::Setup ideal() {
  SrpHarness::Setup setup;
  setup.ideal = true;
  return setup;
}

TEST(SrpIdeal, ALaunchTakesACycleWithoutSwitchDepthOrConflicts) {
  SrpHarness harness(ideal(), {{.ii = 7, .depth = 90, .conflicts = {5, 1}}});
  TileBuilder work;
  work.launch(0, 200);
  harness.add(work.build()).run();
  EXPECT_EQ(harness.cycles(0), 1U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kSwitching), 0U);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kBanks), 0U);
}

TEST(SrpIdeal, ItStillWaitsForItsLinesAllAtOnceUpToTheMshrs) {
  SrpHarness::Setup setup = ideal();
  setup.config.data_cache.mshrs = 4;
  std::vector<std::vector<Access>> eight;
  for (std::uint32_t i = 0; i < 8; ++i) eight.push_back({Access::attributes(i)});
  TileBuilder work;
  work.launch(0, eight);
  SrpHarness harness(setup, {{}});
  harness.add(work.build()).run();
  // Two rounds of memory_latency + 1, with one request and one line per cycle.
  EXPECT_EQ(harness.srp().stats().cache_fills, 8U);
  EXPECT_GE(harness.cycles(0), 2 * SrpHarness::kLine);
  EXPECT_LE(harness.cycles(0), 2 * SrpHarness::kLine + 8);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kCacheMiss), harness.cycles(0) - 1);
}

TEST(SrpIdeal, RaysLeaveWhenTheLinesOfTheirLaunchHaveArrived) {
  SrpHarness harness(ideal(), {{}, {}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {Access::attributes(1)}}), 2);
  work.launch(1, 2, {TileBuilder::each(rays)});
  harness.add(work.build()).run();
  ASSERT_EQ(harness.rays().size(), 2U);
  EXPECT_GE(harness.rays()[0].cycle, SrpHarness::kLine);
}

TEST(SrpIdeal, AnInterfaceWithoutIntervalSendsAnyNumberOfRaysPerCycle) {
  const auto first_ray_at = [](std::uint32_t ray_interval) {
    SrpHarness::Setup setup = ideal();
    setup.ray_interval = ray_interval;
    SrpHarness harness(setup, {{}, {}});
    TileBuilder work;
    work.launch(1, 8, {TileBuilder::each(work.rays(work.launch(0, 8), 8))});
    harness.add(work.build()).run();
    EXPECT_EQ(harness.rays().size(), 8U);
    EXPECT_EQ(harness.srp().stats().rays, 8U);
    return harness.rays().front().cycle;
  };
  EXPECT_EQ(first_ray_at(0), first_ray_at(1));
}

TEST(SrpIdeal, SkippingIdleTimeChangesNothing) {
  const auto play = [](bool skip) {
    SrpHarness harness(ideal(), {{3, 20}, {1, 10}});
    TileBuilder work;
    const auto rays = work.rays(work.launch(0, {{Access::attributes(0)}, {}, {Access::attributes(9)}}), 3);
    work.launch(1, 3, {TileBuilder::each(rays)});
    harness.add(work.build());
    skip ? harness.run<sim::Skip::kOn>() : harness.run<sim::Skip::kOff>();
    return std::vector{harness.cycles(0), harness.cycles(1), harness.spent(Srp::CycleReason::kCacheMiss),
                       harness.spent(Srp::CycleReason::kWaiting)};
  };
  EXPECT_EQ(play(true), play(false));
}

// Tests that a shader core reports each tile, kernel loop and batch of rays to its observer once.

/// Observer that counts events, and the rays in the T&I unit at the end of each batch.
struct CountingObserver : Observer {
  void on_event(const Event& event) override {
    handle_event(event, HandleEvents{
                            [&](const TileStarted&) { tiles_begun += 1; },
                            [&](const TileEnded&) { tiles_ended += 1; },
                            [&](const LoopEnded& loop) { items.push_back(loop.items); },
                            [&](const BatchStarted& batch) {
                              batches_begun.push_back(batch.node);
                              rays_at_begin.push_back(batch.rays);
                              begin = batch.at;
                            },
                            [&](const BatchEnded& ended) {
                              batches_ended.push_back(ended.node);
                              rays_of_batch.push_back(ended.batch->items);
                              rays_at_end.push_back(ended.rays);
                              end = ended.at;
                            },
                            [&](const TransferEnded&) { ADD_FAILURE() << "the DMA reports transfers"; },
                        });
  }

  int tiles_begun = 0, tiles_ended = 0;
  std::vector<std::uint32_t> items, batches_begun, batches_ended, rays_of_batch;
  std::vector<std::uint64_t> rays_at_begin, rays_at_end;
  sim::Time begin = 0, end = 0;
};

TEST(SrpObserver, SeesABatchWithItsFirstRayAndWithItsLastHit) {
  CountingObserver watched;
  SrpHarness::Setup setup;
  setup.observer = &watched;
  SrpHarness harness(setup, {{}, {}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(kA, 5), 5);
  const auto shaded = work.launch(kB, 5, {TileBuilder::each(rays)});
  work.picture(64, shaded);
  harness.add(work.build()).run();
  EXPECT_EQ(watched.tiles_begun, 1);
  EXPECT_EQ(watched.tiles_ended, 1);
  EXPECT_EQ(watched.items, (std::vector<std::uint32_t>{5, 5}));
  EXPECT_EQ(watched.batches_begun, std::vector<std::uint32_t>{rays});
  EXPECT_EQ(watched.batches_ended, std::vector<std::uint32_t>{rays});
  EXPECT_EQ(watched.rays_of_batch, std::vector<std::uint32_t>{5});
  EXPECT_EQ(watched.rays_at_begin, std::vector<std::uint64_t>{1}) << "the first one itself";
  EXPECT_EQ(watched.rays_at_end, std::vector<std::uint64_t>{0});
  EXPECT_LT(watched.begin, watched.end);
}

// Tests of the time in which the T&I unit has no rays while a kernel runs on the array.

std::uint64_t starved(const SrpHarness& harness, traces::KernelId kernel) {
  return harness.srp().kernel_use()[kernel].starved;
}

TEST(SrpStarved, ASingleLaunchWithoutRaysStarvesTheUnitSwitchAndStallsIncluded) {
  SrpHarness harness({}, {{4, 90}});
  TileBuilder work;
  work.launch(kA, {{Access::attributes(0)}, {Access::attributes(1)}});
  harness.add(work.build()).run();
  EXPECT_EQ(starved(harness, kA), SrpHarness::cold(4) + 90 + 4 + (SrpHarness::kLine - SrpHarness::kLoad));
  EXPECT_EQ(starved(harness, kA), harness.cycles(kA));
}

TEST(SrpStarved, TheFirstRayEndsItAndTheLastHitBeginsItAgain) {
  constexpr std::uint32_t kItems = 8;
  SrpHarness harness({}, {{5, 30}, {2, 20}});
  TileBuilder work;
  work.launch(kB, kItems, {TileBuilder::each(work.rays(work.launch(kA, kItems), kItems))});
  harness.add(work.build()).run();
  EXPECT_EQ(starved(harness, kA), SrpHarness::cold(5) + 30) << "until the first item leaves the array";
  EXPECT_EQ(starved(harness, kB), SrpHarness::cold(2) + 20 + (kItems - 1) * 2) << "every hit is back when it begins";
}

TEST(SrpStarved, AKernelIsNotChargedWhileTheUnitIsBusyThroughout) {
  SrpHarness::Setup setup;
  setup.tni_latency = 5000;
  SrpHarness harness(setup, {{1, 10}, {3, 40}});
  TileBuilder tracing(0), other(1);
  tracing.launch(kA, 4, {TileBuilder::each(tracing.rays(tracing.launch(kA, 4), 4))});
  other.launch(kB, 200);
  harness.add(tracing.build()).add(other.build()).run();
  EXPECT_EQ(starved(harness, kB), 0U);
  EXPECT_EQ(harness.cycles(kB), SrpHarness::cold(3) + 40 + 199 * 3);
}

TEST(SrpStarved, AKernelIsChargedOnlyFromTheReturnOfTheLastHit) {
  SrpHarness::Setup setup;
  setup.tni_latency = 300;
  SrpHarness harness(setup, {{1, 10}, {3, 40}});
  TileBuilder tracing(0), other(1);
  tracing.launch(kA, 4, {TileBuilder::each(tracing.rays(tracing.launch(kA, 4), 4))});
  other.launch(kB, 200);
  harness.add(tracing.build()).add(other.build()).run();
  // The last ray leaves when the other tile's kernel is switched in. Its hit returns after a link and the unit's
  // latency.
  EXPECT_EQ(starved(harness, kB), harness.cycles(kB) - (1 + 300));
}

// Tests of idle items, which pass through a kernel loop without work.

SrpHarness::Setup with_chunk(std::uint32_t chunk) {
  SrpHarness::Setup setup;
  setup.config.chunk = chunk;
  return setup;
}

TEST(SrpIdle, IdleItemsTakeTheLoopsTimeAndCountLikeOthers) {
  for (const std::uint32_t chunk : {256U, 16U, 5U}) {
    SrpHarness idle(with_chunk(chunk), {{3, 20}}), busy(with_chunk(chunk), {{3, 20}});
    TileBuilder some, all;
    some.idle(some.launch(kA, 10), 6);
    all.launch(kA, 16);
    idle.add(some.build()).run();
    busy.add(all.build()).run();
    EXPECT_EQ(idle.done_at(0), busy.done_at(0)) << chunk;
    EXPECT_EQ(idle.cycles(kA), busy.cycles(kA));
    EXPECT_EQ(idle.srp().stats().chunks, busy.srp().stats().chunks);
    EXPECT_EQ(idle.srp().stats().items, 16U);
    EXPECT_EQ(idle.srp().stats().config_reads, busy.srp().stats().config_reads);
    EXPECT_EQ(idle.srp().kernel_use()[kA].items, 16U);
    EXPECT_EQ(idle.srp().kernel_use()[kA].idle, 6U);
    EXPECT_EQ(busy.srp().kernel_use()[kA].idle, 0U);
  }
}

TEST(SrpIdle, IdleItemsTouchNoCache) {
  for (const std::uint32_t chunk : {256U, 2U}) {
    SrpHarness harness(with_chunk(chunk), {{4, 50}});
    TileBuilder work;
    const auto launch = work.launch(kA, {{Access::attributes(0)}, {Access::attributes(1)}, {Access::attributes(2)}});
    work.idle(launch, 5);
    work.launch(kA, {{Access::attributes(3)}}, {TileBuilder::all(launch)});
    harness.add(work.build()).run();
    EXPECT_EQ(harness.srp().stats().cache_accesses, 4U) << "the next launch's access is not theirs";
    EXPECT_EQ(harness.srp().stats().items, 9U);
    EXPECT_EQ(harness.srp().stats().queued_loads, 4U);
  }
}

TEST(SrpIdle, IdleItemsMakeNoRaysAndTakeNoSlots) {
  SrpHarness harness(with_chunk(4), {{2, 30}, {1, 10}});
  TileBuilder work;
  const auto launch = work.launch(kA, 6);
  work.idle(launch, 10);
  work.launch(kB, 6, {TileBuilder::each(work.rays(launch, 6))});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.rays().size(), 6U);
  EXPECT_EQ(harness.srp().tile_buffer().stats().slots_taken, 6U);
  EXPECT_EQ(harness.srp().tile_buffer().used_slots(), 0U);
}

TEST(SrpIdle, AReadyLaunchRunsBeforeIdleChunks) {
  SrpHarness harness(with_chunk(8), {{1, 10}, {1, 10}});
  TileBuilder work;
  const auto launch = work.launch(kA, 8);
  work.idle(launch, 8);
  work.picture(64, work.launch(kB, 8, {TileBuilder::all(launch)}));
  harness.add(work.build()).run();
  const std::uint64_t loop = 10 + 7;
  EXPECT_EQ(harness.done_at(0), 2 * SrpHarness::cold(1) + SrpHarness::kResident + 3 * loop)
      << "A, B, then what is left of A while the transfer goes out";
}

}  // namespace

}  // namespace hw
