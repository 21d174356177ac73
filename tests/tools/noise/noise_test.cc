#include "tools/noise/noise.h"

#include <cmath>

#include <gtest/gtest.h>

// Tests of the default noise, which is assumed without replicates.

namespace tools {
namespace {

TEST(DefaultNoise, IsThatOfThePage) {
  const auto noise = [](double width, const char* figure) { return default_noise(width * width / 2, figure); };
  EXPECT_EQ(noise(2048, "cycles"), 0.02);
  EXPECT_EQ(noise(1024, "perf.fps"), 0.02);
  EXPECT_EQ(noise(1023, "perf.fps"), 0.09);
  EXPECT_EQ(noise(512, "power_w.nominal"), 0.09);
  EXPECT_EQ(noise(256, "time_ms"), 0.25);
  EXPECT_EQ(noise(512, "energy_mj.nominal"), 0.05);
  EXPECT_EQ(noise(64, "perf.frames_per_joule_gpu"), 0.05);
  EXPECT_EQ(noise(1024, "dram_bytes"), 0.10);
  EXPECT_EQ(noise(256, "energy_by_block_mj.dram.low"), 0.25) << "energy of traffic moves as traffic";
}

TEST(NoiseOfPair, IsWhatTwoDrawsDifferByInNineteenOfTwentyPairs) {
  EXPECT_NEAR(replicate_noise({10, 200, 5}), 1.959964 * std::sqrt(2.0) * 5 / 200, 1e-6);
}

TEST(MeasuredMetric, OfTwoRunsOfOneDesignDiffersByTheAssumedNoise) {
  const MeasuredMetric run{100, {}, 0.02};
  const MeanDifference d = difference_of(run, run);
  EXPECT_EQ(d.value, 0);
  EXPECT_NEAR(d.half_width(), 2, 1e-9);
}

TEST(MeasuredMetric, HasTheErrorOfItsReplicatesOrOfWhatIsAssumed) {
  const MeasuredMetric measured{100, Draws{4, 100, 6}}, assumed{100, {}, 0.02}, exact{100};
  EXPECT_DOUBLE_EQ(measured.standard_error(), 3);
  EXPECT_NEAR(measured.half_width(), 3 * 3.182446, 1e-5) << "Student, three degrees of freedom";
  EXPECT_NEAR(assumed.standard_error(), 2 / (1.959964 * std::sqrt(2.0)), 1e-6);
  EXPECT_EQ(exact.standard_error(), 0);
}

TEST(MeasuredMetric, OfOneSideWithReplicatesIsHeldAgainstTheOther) {
  const MeasuredMetric measured{100, Draws{4, 100, 6}}, assumed{110, {}, 0.02};
  const MeanDifference d = difference_of(measured, assumed);
  EXPECT_EQ(d.value, 10);
  EXPECT_NEAR(d.error, std::hypot(3, assumed.standard_error()), 1e-12);
}

TEST(NoisyFigures, AreThoseThatRacesMove) {
  EXPECT_TRUE(is_noisy("cycles"));
  EXPECT_TRUE(is_noisy("energy_mj.nominal"));
  EXPECT_TRUE(is_noisy("energy_by_block_mj.dram.high"));
  EXPECT_TRUE(is_noisy("top_down.gpu.data_misses.l2"));
  EXPECT_FALSE(is_noisy("area_mm2"));
  EXPECT_FALSE(is_noisy("cycles_of_another"));
  EXPECT_FALSE(is_noisy("dram_bytes_by_client.frame_buffer"));
  EXPECT_FALSE(is_noisy("relative.rays"));
  EXPECT_FALSE(is_noisy("rays.total"));
}

}  // namespace
}  // namespace tools
