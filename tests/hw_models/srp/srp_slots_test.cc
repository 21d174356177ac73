#include <vector>

#include <gtest/gtest.h>

#include "hw_models/srp/tile_buffer.h"
#include "tests/hw_models/srp/srp_harness.h"

// Tests of a shader core with few ray slots in the tile buffer.

namespace hw {
namespace {

using test::kA, test::kB;
using test::SrpHarness;
using test::TileBuilder;
using test::trace_and_shade;

constexpr std::uint32_t kSamples = 16;

/// Returns a setup whose tile buffer has `slots` ray slots, for tiles of 16 samples.
SrpHarness::Setup with_slots(std::uint32_t slots) {
  SrpHarness::Setup setup;
  setup.tile_samples = kSamples;
  const TileBufferConfig& b = setup.buffer;
  setup.buffer.size.bytes = std::uint64_t{b.tiles_in_flight} * kSamples * b.colour_bytes + slots * b.slot_bytes;
  return setup;
}

TEST(Srp, AYoungerTilesFirstRaysLeaveRoomForATileOfTheOldest) {
  for (const auto& [slots, together] :
       {std::pair{2 * kSamples + kSamples, true}, {2 * kSamples + kSamples - 1, false}}) {
    for (const bool reads_first : {false, true}) {
      SrpHarness::Setup setup = with_slots(slots);
      setup.tni_latency = 900;
      SrpHarness harness(setup, {{1, 50}, {1, 50}});
      harness.add(trace_and_shade(kSamples, 0, reads_first)).add(trace_and_shade(kSamples, 1, reads_first)).run();
      const std::uint64_t both = 2 * kSamples;
      EXPECT_EQ(harness.srp().tile_buffer().stats().slots_peak, together ? both : kSamples) << slots;
      EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 0U) << "it waits, it does not spill";
      EXPECT_EQ(harness.spent(Srp::CycleReason::kNoSlots) > 0, !together);
    }
  }
}

TEST(Srp, AYoungerTilesFirstRaysLeaveRoomForAWaveOfTheOldest) {
  constexpr std::uint32_t kWave = 4;
  for (const auto& [slots, together] : {std::pair{2 * kSamples + kWave, true}, {2 * kSamples + kWave - 1, false}}) {
    SrpHarness::Setup setup = with_slots(slots);
    setup.tni_latency = 900;
    setup.wave_samples = kWave;
    SrpHarness harness(setup, {{1, 50}, {1, 50}});
    harness.add(trace_and_shade(kSamples, 0)).add(trace_and_shade(kSamples, 1)).run();
    EXPECT_EQ(harness.srp().tile_buffer().stats().slots_peak, together ? 2 * kSamples : kSamples) << slots;
    EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 0U);
  }
}

TEST(Srp, RaysWithoutASlotAreSpilledAndReadBackBeforeTheyLeave) {
  SrpHarness harness(with_slots(10), {{1, 50}, {1, 50}});
  harness.add(trace_and_shade(kSamples)).run();
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, kSamples - 10);
  ASSERT_EQ(harness.transfers().size(), 2U);
  for (const DmaJob& job : harness.transfers()) EXPECT_EQ(job.bytes, 2 * (kSamples - 10) * 64);
  EXPECT_TRUE(harness.transfers()[0].write);
  EXPECT_FALSE(harness.transfers()[1].write);
  EXPECT_EQ(harness.rays().size(), kSamples);
}

TEST(Srp, WithoutAnySlotEveryTileStillFinishes) {
  SrpHarness::Setup setup = with_slots(0);
  setup.config.chunk = 3;
  SrpHarness harness(setup, {{1, 50}, {1, 50}});
  for (std::uint32_t t = 0; t < 5; ++t) harness.add(trace_and_shade(kSamples, t));
  harness.run();
  EXPECT_EQ(harness.tiles_done().size(), 5U);
  EXPECT_EQ(harness.srp().tile_buffer().stats().spilled_slots, 5 * kSamples);
  EXPECT_EQ(harness.srp().tile_buffer().used_slots(), 0U);
}

TEST(Srp, EveryCycleHasAReasonAndTheOracleAgreesForAnyNumberOfSlots) {
  for (const std::uint32_t slots : {0U, 5U, 16U, 33U, 1000U}) {
    for (const std::uint32_t chunk : {1U, 5U, 256U}) {
      SrpHarness::Setup setup = with_slots(slots);
      setup.config.chunk = chunk;
      setup.ray_interval = 3;
      const std::vector<SrpHarness::Kernel> kernels = {{2, 33}, {5, 71}};
      SrpHarness fast(setup, kernels), oracle(setup, kernels);
      for (std::uint32_t t = 0; t < 6; ++t) {
        fast.add(trace_and_shade(kSamples, t));
        oracle.add(trace_and_shade(kSamples, t));
      }
      fast.run();
      oracle.run<sim::Skip::kOff>();
      SCOPED_TRACE(testing::Message() << "slots " << slots << ", chunk " << chunk);
      test::expect_equal_cycles(fast, oracle);
    }
  }
}

constexpr sim::Clock kClock{1'000'000};

TEST(TileBuffer, RaySlotsFillTheRoomAfterTheColoursOfTilesInFlight) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), (65536U - 3 * 256 * 16) / 64);
  config.tiles_in_flight = 1;
  config.colour_bytes = 12;
  config.slot_bytes = 96;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), (65536U - 256 * 12) / 96);
}

TEST(TileBuffer, SmallerThanTheColoursItHasNoSlots) {
  TileBufferConfig config;
  config.size.bytes = 12 * 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), 0U);
  config.size.bytes = 1024;
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256}, kClock).slot_count(), 0U);
}

TEST(TileBuffer, AttributesOfTheTilesInFlightLeaveFewerRaySlots) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  const std::uint64_t without = TileBuffer(config, {.tile_samples = 256}, kClock).slot_count();
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256, .attribute_bytes = 64 * 25}, kClock).slot_count(),
            without - 3 * 25);
  EXPECT_EQ(TileBuffer(config, {.tile_samples = 256, .attribute_bytes = 256 * 1024}, kClock).slot_count(), 0U);
}

TEST(TilesInFlight, RaySlotsKeepTheirShareAtTheCostOfTiles) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  const traces::FrameRequirements light{.tile_samples = 256}, heavy{.tile_samples = 256, .attribute_bytes = 12 * 1024};
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 3U);
  config.ray_share = 0.5;
  EXPECT_EQ(tiles_in_flight(config, light, false).first, 3U);
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 2U);
  EXPECT_EQ(TileBuffer(config, heavy, kClock).slot_count(), 32U * 1024 / 64);
  EXPECT_EQ(tiles_in_flight(config, heavy, true).first, 3U) << "an ideal buffer has room for all";
  config.ray_share = 0.9;
  EXPECT_EQ(tiles_in_flight(config, heavy, false).first, 1U) << "one there always is";
}

TEST(TilesInFlight, TilesOfLaterPassesShareTheRoomOfThoseOfTheFirst) {
  TileBufferConfig config;
  config.size.bytes = 64 * 1024;
  config.tiles_in_pass = 16;
  traces::FrameRequirements needs{.tile_samples = 256, .attribute_bytes = 4 * 1024};
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U) << "they keep as much";
  needs.pass_attribute_bytes = 1024;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U * 8 / 5);
  config.colour_bytes = 4;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 3U * 5 / 2) << "smaller accumulators leave room for more";
  config.tiles_in_pass = 5;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 5U);
  needs.pass_attribute_bytes = 64 * 1024;
  EXPECT_EQ(tiles_in_flight(config, needs, false).later, 1U);
}

TEST(TileBuffer, SlotsTakenAreNotFreeUntilReturned) {
  TileBufferConfig config;
  config.size.bytes = 3 * 256 * 16 + 64 * 100;
  TileBuffer buffer(config, {.tile_samples = 256}, kClock);
  EXPECT_EQ(buffer.allocate_slots(60), 0U);
  EXPECT_EQ(buffer.free_slots(), 40U);
  EXPECT_EQ(buffer.allocate_slots(40), 0U);
  EXPECT_EQ(buffer.free_slots(), 0U);
  buffer.free_ray_slots(70);
  EXPECT_EQ(buffer.free_slots(), 70U);
  EXPECT_EQ(buffer.used_slots(), 30U);
  EXPECT_EQ(buffer.stats().slots_taken, 100U);
  EXPECT_EQ(buffer.stats().slots_peak, 100U);
  EXPECT_EQ(buffer.stats().spilled_slots, 0U);
}

TEST(TileBuffer, OnlySlotsThatDoNotFitAreSpilled) {
  TileBufferConfig config;
  config.size.bytes = 3 * 256 * 16 + 64 * 100;
  TileBuffer buffer(config, {.tile_samples = 256}, kClock);
  EXPECT_EQ(buffer.allocate_slots(130), 30U);
  EXPECT_EQ(buffer.allocate_slots(10), 10U) << "nothing is free any more";
  buffer.free_ray_slots(60);
  EXPECT_EQ(buffer.free_slots(), 20U) << "140 were taken, 80 are still in use";
  EXPECT_EQ(buffer.stats().spilled_slots, 40U);
}

TEST(TileBuffer, IsIdleOrInUseInEveryCycle) {
  TileBuffer buffer({}, {.tile_samples = 256}, kClock);
  buffer.set_in_use(10 * kClock.period(), true);
  buffer.set_in_use(50 * kClock.period(), false);
  buffer.set_in_use(70 * kClock.period(), true);
  buffer.finish(100 * kClock.period());
  EXPECT_EQ(kClock.cycles(buffer.activity().spent(TileBuffer::CycleReason::kInUse)), 40U + 30U);
  EXPECT_EQ(kClock.cycles(buffer.activity().spent(TileBuffer::CycleReason::kIdle)), 10U + 20U);
}

}  // namespace
}  // namespace hw
