#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Tests of transfers that read borders of other tiles: which nodes wait for a border, and which messages announce one.

namespace hw {
namespace {

using test::kA, test::kB;
using test::kSwitch;
using test::SrpHarness;
using test::TileBuilder;
using CycleReason = Srp::CycleReason;

constexpr std::uint64_t kDma = 1 + 5;               // cycles: cold kernel; link to the DMA, and its answer
constexpr std::uint64_t kLoop = kSwitch + 10 + 15;  // cycles of a loop of sixteen items, including the switch
constexpr std::uint64_t kStart = 1;                 // the first cycle in which the shader core sees a tile

/// Returns a tile that imports `imports` borders; `missing` of these are missing at first. One launch needs no border,
/// another needs all.
traces::TileWork importing(std::uint32_t imports, std::uint32_t tile = 1) {
  TileBuilder work(tile);
  std::vector<traces::Edge> all = {TileBuilder::all(work.launch(kA, 16))};
  for (std::uint32_t i = 0; i < imports; ++i) all.push_back(TileBuilder::all(work.import_border({0, i}, 64)));
  work.launch(kA, 16, all);
  return work.build();
}

TEST(SrpBorders, AnImportWaitsForItsBorderAndTheRestOfTheTileDoesNot) {
  SrpHarness harness({}, {{1, 10}});
  harness.add(importing(1), 1).tell(1000, 0, 0).run();
  EXPECT_EQ(harness.spent(CycleReason::kRunning), 2U * (10 + 15));
  // The update arrives, then the transfer runs, then the launch that waits for it, whose kernel is resident.
  EXPECT_EQ(harness.done_at(0), 1000 + 1 - kStart + kDma + 10 + 15);
  EXPECT_EQ(harness.spent(CycleReason::kBorders), 1000 + 1 - kStart - kLoop);
  EXPECT_EQ(harness.spent(CycleReason::kWaiting), kDma);
}

TEST(SrpBorders, ABorderInMemoryIsReadAtOnce) {
  SrpHarness harness({}, {{1, 10}}), without({}, {{1, 10}});
  harness.add(importing(1), 0).run();
  EXPECT_EQ(harness.done_at(0), kLoop + 10 + 15) << "the transfer is done long before the first launch is";
  EXPECT_EQ(harness.spent(CycleReason::kBorders), 0U);
}

TEST(SrpBorders, EachImportStartsWithItsOwnUpdate) {
  SrpHarness harness({}, {{1, 10}});
  harness.add(importing(3), 0b111).tell(1000, 0, 0b101).tell(2000, 0, 0b100).tell(3000, 0, 0).run();
  EXPECT_EQ(harness.transfers().size(), 3U);
  EXPECT_EQ(harness.done_at(0), 3000 + 1 - kStart + kDma + 10 + 15);
  EXPECT_EQ(harness.spent(CycleReason::kWaiting), 3 * kDma) << "the time of the transfers is the DMA's";
  EXPECT_EQ(harness.spent(CycleReason::kBorders), 3000 + 1 - kStart - kLoop - 2 * kDma);
}

TEST(SrpBorders, ABorderIsReportedWhenItsTransferIsDoneAndTheTileContinues) {
  SrpHarness harness({}, {{1, 10}, {1, 500}});
  TileBuilder work(7);
  const auto launch = work.launch(kA, 16);
  work.export_border(2, 64, {TileBuilder::all(launch)});
  work.export_border(0, 64, {TileBuilder::all(work.launch(kB, 16, {TileBuilder::all(launch)}))});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.borders(), (std::vector<traces::Border>{{7, 2}, {7, 0}}));
  EXPECT_EQ(harness.tiles_done(), (std::vector<std::uint32_t>{7})) << "the end is a message of its own";
}

TEST(SrpBorders, AnotherTileRunsMeanwhile) {
  SrpHarness harness({}, {{1, 10}, {1, 20}});
  TileBuilder other(2);
  other.launch(kB, 160);
  harness.add(importing(1), 1).add(other.build()).tell(1000, 0, 0).run();
  EXPECT_EQ(harness.tiles_done(), (std::vector<std::uint32_t>{2, 1}));
}

SrpHarness::Setup room_for(std::uint32_t slots) {
  SrpHarness::Setup setup;
  const TileBufferConfig& b = setup.buffer;
  setup.buffer.size.bytes =
      std::uint64_t{b.tiles_in_flight} * setup.tile_samples * b.colour_bytes + std::uint64_t{slots} * b.slot_bytes;
  return setup;
}

/// Returns a tile that makes 16 rays `times` times and keeps their slots. With `imports` it first waits for a border.
traces::TileWork tracing(std::uint32_t tile, std::uint32_t times, bool imports) {
  TileBuilder work(tile);
  std::vector<traces::Edge> inputs, rays;
  if (imports) inputs = {TileBuilder::all(work.import_border({0, 0}, 64))};
  for (std::uint32_t i = 0; i < times; ++i) {
    const auto batch = work.rays(work.launch(kA, 16, inputs), 16);
    inputs = {TileBuilder::each(batch)};
    rays.push_back(TileBuilder::all(batch));
  }
  work.launch(kB, 16, rays);
  return work.build();
}

TEST(SrpBorders, TheOldestTileSpillsThoughAYoungerOneWaitsForItsBorder) {
  SrpHarness harness(room_for(16), {{1, 10}, {1, 10}});
  harness.add(tracing(0, 2, false)).add(importing(1), 1).tell(100'000, 1, 0).run();
  EXPECT_LT(harness.done_at(0), 10'000U) << "no tile waits for an update that only this tile sends";
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 16U);
}

TEST(SrpBorders, NothingSpillsWhileTheOldestTileWaitsForABorder) {
  SrpHarness harness(room_for(16), {{1, 10}, {1, 10}});
  harness.add(tracing(1, 1, true), 1).add(tracing(2, 1, false)).tell(100'000, 0, 0).run();
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 0U);
  EXPECT_EQ(harness.tiles_done(), (std::vector<std::uint32_t>{1, 2})) << "the younger one leaves it the slots";
}

TEST(SrpBorders, TheOracleAgrees) {
  for (const std::uint64_t cycle : {3U, 50U, 126U, 127U, 400U}) {
    SrpHarness fast(room_for(40), {{2, 33}, {5, 71}}), oracle(room_for(40), {{2, 33}, {5, 71}});
    for (SrpHarness* harness : {&fast, &oracle}) {
      harness->add(tracing(0, 2, false)).add(importing(2), 0b11).add(tracing(2, 2, true), 1);
      harness->tell(cycle + 3, 1, 0b10).tell(cycle + 200, 1, 0).tell(cycle + 700, 2, 0);
    }
    fast.run();
    oracle.run<sim::Skip::kOff>();
    EXPECT_EQ(fast.elapsed(), oracle.elapsed());
    std::uint64_t sum = 0;
    for (std::size_t w = 0; w < static_cast<std::size_t>(CycleReason::kCount); ++w) {
      EXPECT_EQ(fast.spent(static_cast<CycleReason>(w)), oracle.spent(static_cast<CycleReason>(w))) << w;
      sum += fast.spent(static_cast<CycleReason>(w));
    }
    EXPECT_EQ(sum, fast.elapsed());
  }
}

}  // namespace
}  // namespace hw
