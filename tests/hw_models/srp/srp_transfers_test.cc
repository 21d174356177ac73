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
    EXPECT_EQ(fast.elapsed(), oracle.elapsed());
    for (std::size_t w = 0; w < static_cast<std::size_t>(Srp::CycleReason::kCount); ++w) {
      EXPECT_EQ(fast.spent(static_cast<Srp::CycleReason>(w)), oracle.spent(static_cast<Srp::CycleReason>(w)));
    }
    EXPECT_EQ(fast.srp().tile_buffer().used_slots(), 0U);
  }
}

}  // namespace
}  // namespace hw
