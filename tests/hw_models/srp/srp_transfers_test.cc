#include <vector>

#include <gtest/gtest.h>

#include "tests/hw_models/srp/srp_harness.h"

// Tests of transfers between tile buffer and memory: their start, the nodes that wait for them, and their addresses.

namespace hw {
namespace {

using test::kA, test::kB;
using test::kSwitch;
using test::SrpHarness;
using test::TileBuilder;
using traces::Region;

constexpr std::uint64_t kDma = 1 + 5;  // cycles: to a kernel of interval 1; to the DMA and back

Addr base_of(Area area) { return SrpHarness::kBases[static_cast<std::size_t>(area)]; }

TEST(SrpTransfers, APictureFollowsTheLaunchItWaitsForAndEndsTheTile) {
  SrpHarness harness({}, {{1, 10}});
  TileBuilder work;
  work.picture(64, work.launch(kA, 16));
  harness.add(work.build()).run();
  ASSERT_EQ(harness.transfers().size(), 1U);
  EXPECT_TRUE(harness.transfers()[0].write);
  EXPECT_EQ(harness.transfers()[0].bytes, 64U);
  EXPECT_EQ(harness.done_at(0), kSwitch + 10 + 15 + kDma);
}

TEST(SrpTransfers, EachRegionHasItsPlaceInMemoryAndBothDirections) {
  SrpHarness harness({}, {{1, 10}});
  TileBuilder work;
  const auto launch = work.launch(kA, 16);
  for (const Region region : {Region::kPicture, Region::kSamples, Region::kRates}) {
    work.transfer(region, true, 100, {TileBuilder::all(launch)}, 640);
    work.transfer(region, false, 40, {TileBuilder::all(launch)}, 1280);
  }
  harness.add(work.build()).run();
  ASSERT_EQ(harness.transfers().size(), 6U);
  std::size_t i = 0;
  for (const Area area : {Area::kPicture, Area::kSamples, Area::kRates}) {
    EXPECT_EQ(harness.transfers()[i].base, base_of(area) + 640);
    EXPECT_EQ(harness.transfers()[i].bytes, 100U);
    EXPECT_TRUE(harness.transfers()[i++].write);
    EXPECT_EQ(harness.transfers()[i].base, base_of(area) + 1280);
    EXPECT_EQ(harness.transfers()[i].bytes, 40U);
    EXPECT_FALSE(harness.transfers()[i++].write);
  }
}

TEST(SrpTransfers, AWriteReadsTheTileBufferAndAReadWritesIt) {
  for (const bool to_memory : {true, false}) {
    SrpHarness harness({}, {{1, 10}});
    TileBuilder work;
    work.transfer(Region::kSamples, to_memory, 100, {TileBuilder::all(work.launch(kA, 1))});
    harness.add(work.build()).run();
    const TileBuffer::Stats& buffer = harness.srp().tile_buffer().stats();
    EXPECT_EQ(buffer.reads, to_memory ? 7U : 0U) << "sixteen bytes at a time";
    EXPECT_EQ(buffer.writes, to_memory ? 0U : 7U);
  }
}

TEST(SrpTransfers, ATransferWithoutInputsStartsWithTheTileAndALaunchWaitsForIt) {
  SrpHarness::Setup setup;
  setup.dma_latency = 300;
  SrpHarness harness(setup, {{1, 10}});
  TileBuilder work;
  work.launch(kA, 16, {TileBuilder::all(work.transfer(Region::kRates, false, 64))});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.done_at(0), 1 + 300 + kSwitch + 10 + 15);
  EXPECT_EQ(harness.spent(Srp::CycleReason::kWaiting), 1U + 300U);
}

TEST(SrpTransfers, WhileATileWaitsForItsTransferAnotherRuns) {
  SrpHarness::Setup setup;
  setup.dma_latency = 300;
  SrpHarness harness(setup, {{1, 10}, {1, 20}});
  TileBuilder first(0), second(1);
  first.launch(kA, 16, {TileBuilder::all(first.transfer(Region::kSamples, false, 64))});
  second.launch(kB, 16);
  harness.add(first.build()).add(second.build()).run();
  EXPECT_EQ(harness.tiles_done(), (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(harness.done_at(1), 1 + 300 + kSwitch + 10 + 15) << "the read went on under the other tile's launch";
}

TEST(SrpTransfers, ATransferWaitsForAllOfItsInputsNotForTheLastAlone) {
  SrpHarness harness({}, {{1, 10}, {1, 400}});
  TileBuilder work;
  const auto slow = work.launch(kB, 16);
  const auto quick = work.launch(kA, 16);  // runs first, because the last ready node has priority
  work.transfer(Region::kSamples, true, 64, {TileBuilder::all(slow), TileBuilder::all(quick)});
  work.transfer(Region::kSamples, true, 128, {TileBuilder::all(quick), TileBuilder::all(slow)});
  work.transfer(Region::kSamples, true, 192, {TileBuilder::all(quick)});
  harness.add(work.build()).run();
  std::vector<std::uint32_t> bytes;
  for (const DmaJob& job : harness.transfers()) bytes.push_back(job.bytes);
  EXPECT_EQ(bytes, (std::vector<std::uint32_t>{192, 64, 128}));
}

TEST(SrpTransfers, ATransferMayWaitForAnother) {
  SrpHarness harness({}, {{1, 10}});
  TileBuilder work;
  const auto out = work.transfer(Region::kSamples, true, 64, {TileBuilder::all(work.launch(kA, 16))});
  const auto in = work.transfer(Region::kSamples, false, 64, {TileBuilder::all(out)});
  work.launch(kA, 16, {TileBuilder::all(in)});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.done_at(0), kSwitch + 10 + 15 + 2 * kDma + 10 + 15);
}

TEST(SrpTransfers, ATransferMayWaitForRaysAndKeepsTheirSlotsUntilItIsDone) {
  SrpHarness::Setup setup;
  setup.dma_latency = 500;
  SrpHarness harness(setup, {{1, 10}, {1, 10}});
  TileBuilder work;
  const auto rays = work.rays(work.launch(kA, 16), 16);
  work.transfer(Region::kSamples, true, 256, {TileBuilder::all(rays)});
  harness.add(work.build()).run();
  EXPECT_EQ(harness.done_at(0), kSwitch + 10 + 15 + 11 + 1 + 500) << "launch, T&I unit, DMA";
  EXPECT_EQ(harness.srp().tile_buffer().used_slots(), 0U) << "the transfer was the last that read them";
}

TEST(SrpTransfers, NothingSpillsWhileALaunchWaitsForDataInFlight) {
  SrpHarness::Setup setup;
  setup.dma_latency = 300;
  const TileBufferConfig& b = setup.buffer;
  setup.buffer.size.bytes = std::uint64_t{b.tiles_in_flight} * setup.tile_samples * b.colour_bytes + 16 * b.slot_bytes;
  SrpHarness harness(setup, {{1, 10}, {1, 10}});
  TileBuilder first(0), second(1);
  const auto trace = [](TileBuilder& work, std::vector<traces::Edge> inputs) {
    work.launch(kB, 16, {TileBuilder::each(work.rays(work.launch(kA, 16, std::move(inputs)), 16))});
  };
  trace(first, {TileBuilder::all(first.transfer(Region::kRates, false, 64))});
  trace(second, {});
  harness.add(first.build()).add(second.build()).run();
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 0U);
  EXPECT_EQ(harness.tiles_done(), (std::vector<std::uint32_t>{0, 1})) << "the second leaves the slots to the first";
}

TEST(SrpTransfers, TheOracleAgreesOnChainsOfTransfersAndLaunches) {
  for (const std::uint32_t latency : {1U, 7U, 90U}) {
    SrpHarness::Setup setup;
    setup.dma_latency = latency;
    setup.config.chunk = 5;
    const auto fill = [](SrpHarness& harness) -> SrpHarness& {
      for (std::uint32_t t = 0; t < 5; ++t) {
        TileBuilder work(t);
        const auto in = work.transfer(Region::kRates, false, 16);
        const auto halo = work.transfer(Region::kSamples, false, 300);
        const auto rays = work.rays(work.launch(kA, 16, {TileBuilder::all(in)}), 16);
        const auto out = work.transfer(Region::kSamples, true, 256, {TileBuilder::all(rays)});
        const auto shade = work.launch(kB, 16, {TileBuilder::each(rays), TileBuilder::all(halo)});
        work.transfer(Region::kPicture, true, 64, {TileBuilder::all(out), TileBuilder::all(shade)});
        harness.add(work.build());
      }
      return harness;
    };
    const std::vector<SrpHarness::Kernel> kernels = {{2, 33}, {5, 71}};
    SrpHarness fast(setup, kernels), oracle(setup, kernels);
    fill(fast).run();
    fill(oracle).run<sim::Skip::kOff>();
    test::expect_equal_cycles(fast, oracle);
    EXPECT_EQ(fast.srp().tile_buffer().used_slots(), 0U);
  }
}

// Tests of transfers that read borders of other tiles: which nodes wait for a border, and which messages announce one.

using CycleReason = Srp::CycleReason;

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
    test::expect_equal_cycles(fast, oracle);
  }
}

}  // namespace
}  // namespace hw
