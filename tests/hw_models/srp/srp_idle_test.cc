#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Tests of idle items, which pass through a kernel loop without work.

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;
using traces::Access;

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
