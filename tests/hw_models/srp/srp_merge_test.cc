#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hw_models/memory/tile_accounting.h"
#include "tests/hw_models/srp/srp_harness.h"

// Tests that launches of one kernel that are ready together, from any tile in flight, run as one loop.

namespace hw {
namespace {

using test::kA, test::kB;
using test::kSwitch;
using test::SrpHarness;
using test::TileBuilder;
using CycleReason = Srp::CycleReason;

const std::vector<SrpHarness::Kernel> kKernels = {{1, 10}, {1, 10}};
constexpr std::uint64_t kFirst =
    kSwitch + 10 + 499;  // cycles of a loop that occupies the array until all tiles have arrived

SrpHarness::Setup merging(std::uint32_t chunk = 512) {
  SrpHarness::Setup setup;
  setup.config.merge = true;
  setup.config.chunk = chunk;
  setup.buffer.tiles_in_flight = 4;
  return setup;
}

traces::TileWork keeps_the_array() {
  TileBuilder work(0);
  work.launch(kB, 500);
  return work.build();
}

/// Returns a tile with one launch of sixteen items.
traces::TileWork short_tile(std::uint32_t tile) {
  TileBuilder work(tile);
  work.launch(kA, 16);
  return work.build();
}

TEST(SrpMerge, LaunchesThatWaitTogetherPayOneSwitchOnePrologueAndOneDrain) {
  SrpHarness harness(merging(), kKernels);
  harness.add(keeps_the_array()).add(short_tile(1)).add(short_tile(2)).add(short_tile(3)).run();
  EXPECT_EQ(harness.done_at(0), kFirst);
  EXPECT_EQ(harness.done_at(1), kFirst + kSwitch + 10 + 3 * 16 - 1);
  EXPECT_EQ(harness.done_at(3), harness.done_at(1) + 2) << "all end at once, and say so one a cycle";
  const SrpStats& stats = harness.srp().stats();
  EXPECT_EQ(stats.chunks, 2U);
  EXPECT_EQ(stats.launches, 4U);
  EXPECT_EQ(stats.merged, 1U);
  EXPECT_EQ(harness.srp().kernel_use()[kA].launches, 1U);
  EXPECT_EQ(harness.srp().kernel_use()[kA].items, 48U);
}

TEST(SrpMerge, ALoopsCyclesAreDividedAmongItsTilesExactly) {
  TileAccounting accounting(0);
  SrpHarness::Setup setup = merging();
  setup.observer = &accounting;
  SrpHarness harness(setup, kKernels);
  harness.add(keeps_the_array()).add(short_tile(1)).add(short_tile(2)).add(short_tile(3)).run();
  EXPECT_EQ(accounting.account_without_tile().srp_cycles, harness.cycles(kA) + harness.cycles(kB))
      << "all tiles go by no name here";
}

TEST(SrpMerge, WithoutMergingEachLaunchPaysItsOwnSwitchPrologueAndDrain) {
  SrpHarness::Setup setup = merging();
  setup.config.merge = false;
  SrpHarness harness(setup, kKernels);
  harness.add(keeps_the_array()).add(short_tile(1)).add(short_tile(2)).run();
  EXPECT_EQ(harness.done_at(2), kFirst + kSwitch + 2 * (10 + 15));
  EXPECT_EQ(harness.srp().stats().launches, harness.srp().stats().chunks);
  EXPECT_EQ(harness.srp().stats().merged, 0U);
}

TEST(SrpMerge, LaunchesWaitForNoOthersAndOtherKernelsStayApart) {
  SrpHarness harness(merging(), kKernels);
  TileBuilder other(2);
  other.launch(kB, 16);
  harness.add(short_tile(1)).add(other.build()).run();
  EXPECT_EQ(harness.done_at(0), kSwitch + 10 + 15);
  EXPECT_EQ(harness.srp().stats().merged, 0U);
}

TEST(SrpMerge, ALoopHoldsNoMoreThanAChunk) {
  for (const auto& [chunk, loops] : {std::pair{48U, 1U}, {47U, 2U}, {32U, 2U}, {31U, 3U}}) {
    SrpHarness harness(merging(chunk), kKernels);
    harness.add(keeps_the_array()).add(short_tile(1)).add(short_tile(2)).add(short_tile(3)).run();
    EXPECT_EQ(harness.srp().kernel_use()[kA].launches, loops) << chunk;
    EXPECT_EQ(harness.srp().kernel_use()[kA].items, 48U);
  }
}

TEST(SrpMerge, RaysLeaveWithTheirItemsAndIdleItemsComeLast) {
  SrpHarness harness(merging(), kKernels);
  harness.add(keeps_the_array());
  for (const std::uint32_t tile : {1U, 2U}) {
    TileBuilder work(tile);
    const auto launch = work.launch(kA, 16);
    work.idle(launch, 100);
    work.launch(kB, 16, {TileBuilder::all(work.rays(launch, 16))});
    harness.add(work.build());
  }
  harness.run();
  ASSERT_EQ(harness.rays().size(), 32U);
  for (std::uint32_t i = 0; i < 32; ++i) {
    EXPECT_EQ(harness.rays()[i].ray, i % 16);
    EXPECT_EQ(harness.rays()[i].cycle, harness.rays()[0].cycle + i) << "an item a cycle, the second tile's behind";
  }
  EXPECT_EQ(harness.srp().kernel_use()[kA].idle, 200U);
  EXPECT_EQ(harness.srp().kernel_use()[kA].launches, 1U);
}

TEST(SrpMerge, RaysOfAJoiningLaunchMustFitAsWithoutMerging) {
  SrpHarness::Setup setup = merging();
  setup.tile_samples = 16;
  const TileBufferConfig& b = setup.buffer;
  setup.buffer.size.bytes = std::uint64_t{b.tiles_in_flight} * 16 * b.colour_bytes + 47 * b.slot_bytes;
  SrpHarness harness(setup, kKernels);
  for (const std::uint32_t tile : {1U, 2U}) {
    TileBuilder work(tile);
    const auto rays =
        work.rays(work.launch(kA, 16, {TileBuilder::all(work.transfer(traces::Region::kRates, false, 9))}), 16);
    work.launch(kB, 16, {TileBuilder::all(rays)});
    harness.add(work.build());
  }
  harness.run();
  EXPECT_EQ(harness.srp().kernel_use()[kA].launches, 2U) << "the younger tile leaves sixteen slots to the older one";
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 0U);
}

TEST(SrpMerge, EveryItemReadsItsOwnLines) {
  for (const bool merge : {false, true}) {
    SrpHarness::Setup setup = merging();
    setup.config.merge = merge;
    SrpHarness harness(setup, kKernels);
    harness.add(keeps_the_array());
    for (const std::uint32_t tile : {1U, 2U}) {
      TileBuilder work(tile);
      std::vector<std::vector<traces::Access>> reads;
      for (std::uint32_t i = 0; i < 5; ++i) reads.push_back({traces::Access::attributes(100 * tile + i)});
      reads[3].clear();
      work.launch(kB, {{traces::Access::attributes(7)}});
      work.idle(work.launch(kA, reads), 3);
      harness.add(work.build());
    }
    harness.run();
    EXPECT_EQ(harness.srp().stats().merged > 0, merge);
    EXPECT_EQ(harness.srp().stats().cache_fills, 9U) << "eight items' lines, and the one that both share";
  }
}

TEST(SrpMerge, ALaunchThatReadsMemoryAndOneThatDoesNotStayApart) {
  SrpHarness harness(merging(), kKernels);
  TileBuilder reads(1);
  reads.launch(kA, {{traces::Access::attributes(1)}, {traces::Access::attributes(2)}});
  harness.add(keeps_the_array()).add(reads.build()).add(short_tile(2)).run();
  EXPECT_EQ(harness.srp().stats().merged, 0U);
  EXPECT_EQ(harness.srp().stats().cache_fills, 2U);
}

TEST(SrpMerge, TheOracleAgreesAndEveryCycleHasAReason) {
  for (const std::uint32_t chunk : {5U, 40U, 256U}) {
    const auto fill = [](SrpHarness& harness) -> SrpHarness& {
      for (std::uint32_t t = 0; t < 8; ++t) {
        TileBuilder work(t);
        const auto in = work.transfer(traces::Region::kRates, false, 16);
        const auto made = work.launch(kA, 16, {TileBuilder::all(in)});
        work.idle(made, 3 * t);
        const auto rays = work.rays(made, 16);
        const auto shade = work.launch(kB, 16, {TileBuilder::each(rays)});
        work.launch(kA, 3 + t, {TileBuilder::all(shade)});
        work.picture(64, work.launch(kA, 5, {TileBuilder::all(shade)}));
        harness.add(work.build());
      }
      return harness;
    };
    SrpHarness fast(merging(chunk), {{2, 33}, {5, 71}}), oracle(merging(chunk), {{2, 33}, {5, 71}});
    fill(fast).run();
    fill(oracle).run<sim::Skip::kOff>();
    test::expect_equal_cycles(fast, oracle);
    EXPECT_EQ(fast.srp().stats().merged > 0, chunk >= 40);
    EXPECT_EQ(fast.srp().stats().merged, oracle.srp().stats().merged);
    std::uint64_t busy = 0;
    for (const CycleReason why :
         {CycleReason::kRunning, CycleReason::kSwitching, CycleReason::kBanks, CycleReason::kCacheMiss}) {
      busy += fast.spent(why);
    }
    EXPECT_EQ(fast.cycles(kA) + fast.cycles(kB), busy) << "each loop's cycles are its kernel's";
    EXPECT_EQ(fast.srp().tile_buffer().used_slots(), 0U);
  }
}

}  // namespace
}  // namespace hw
