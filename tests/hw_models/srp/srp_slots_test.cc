#include <vector>

#include <gtest/gtest.h>

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
      EXPECT_EQ(fast.elapsed(), oracle.elapsed());
      std::uint64_t sum = 0;
      for (std::size_t w = 0; w < static_cast<std::size_t>(Srp::CycleReason::kCount); ++w) {
        const auto why = static_cast<Srp::CycleReason>(w);
        EXPECT_EQ(fast.spent(why), oracle.spent(why))
            << Srp::kReasons[w].name << ", slots " << slots << ", chunk " << chunk;
        sum += fast.spent(why);
      }
      EXPECT_EQ(sum, fast.elapsed());
    }
  }
}

}  // namespace
}  // namespace hw
