#include "tools/noise/noise.h"

#include <array>
#include <cmath>
#include <vector>

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

// Tests of means, confidence intervals and significance tests against closed forms.

TEST(Draws, MeanDeviationAndIntervalAreThoseOfTheTextbook) {
  const Draws draws = draw_statistics(std::array{1.0, 2.0, 3.0, 4.0, 5.0});
  EXPECT_EQ(draws.count, 5U);
  EXPECT_DOUBLE_EQ(draws.mean, 3);
  EXPECT_DOUBLE_EQ(draws.deviation, std::sqrt(2.5));
  EXPECT_NEAR(draws.half_width(), 2.776445 * std::sqrt(2.5 / 5), 1e-6);  // table of Student's t, four degrees
}

TEST(Draws, OneDrawHasNoInterval) {
  const Draws draws = draw_statistics(std::array{7.0});
  EXPECT_EQ(draws.mean, 7);
  EXPECT_EQ(draws.deviation, 0);
  EXPECT_EQ(draws.half_width(), 0);
}

TEST(StudentT, OneDegreeIsCauchysDistribution) {
  // For one degree of freedom the quantile is tan(pi (p - 1/2)), and the tail 1/2 - atan(t) / pi.
  EXPECT_NEAR(student_t_quantile(1), std::tan(M_PI * 0.475), 1e-9);
  EXPECT_NEAR(student_t_quantile(1, 0.75), 1, 1e-12);
  EXPECT_NEAR(student_t_tail(1, 1), 0.25, 1e-12);
  EXPECT_NEAR(student_t_tail(-3, 1), 0.5 + std::atan(3) / M_PI, 1e-12);
}

TEST(StudentT, IsThatOfTheTables) {
  EXPECT_NEAR(student_t_quantile(1), 12.7062, 0.0001);
  EXPECT_NEAR(student_t_quantile(2), 4.3027, 0.0001);
  EXPECT_NEAR(student_t_quantile(3), 3.1824, 0.0001);
  EXPECT_NEAR(student_t_quantile(10), 2.2281, 0.0001);
  EXPECT_NEAR(student_t_quantile(30), 2.0423, 0.0001);
  EXPECT_NEAR(student_t_quantile(1e9), 1.9600, 0.0001);
}

TEST(MeanDifference, EqualVariancesAndCountsHaveTheDegreesOfBoth) {
  const MeanDifference d = difference_of({5, 10, 2}, {5, 13, 2});
  EXPECT_DOUBLE_EQ(d.value, 3);
  EXPECT_DOUBLE_EQ(d.error, std::sqrt(8.0 / 5));
  EXPECT_DOUBLE_EQ(d.degrees, 8);
  EXPECT_NEAR(d.half_width(), 2.306004 * std::sqrt(1.6), 1e-6);
  EXPECT_NEAR(d.one_sided_p_value(), student_t_tail(3 / std::sqrt(1.6), 8), 1e-15);
}

TEST(MeanDifference, ASideThatDoesNotVaryLeavesTheDegreesOfTheOther) {
  const MeanDifference d = difference_of({9, 10, 0}, {5, 13, 2});
  EXPECT_DOUBLE_EQ(d.degrees, 4);
  EXPECT_DOUBLE_EQ(d.error, 2 / std::sqrt(5.0));
}

TEST(MeanDifference, WhatDoesNotVaryIsSure) {
  EXPECT_EQ(difference_of({5, 10, 0}, {5, 11, 0}).half_width(), 0);
  EXPECT_EQ(difference_of({5, 10, 0}, {5, 11, 0}).one_sided_p_value(), 0);
  EXPECT_EQ(difference_of({5, 10, 0}, {5, 10, 0}).one_sided_p_value(), 1);
}

TEST(Holm, ComparesEachChanceWithWhatTheNumberOfThoseLeftAllows) {
  // Holm's test: 0.01 <= 0.05 / 4 and 0.016 <= 0.05 / 3, but 0.026 > 0.05 / 2; the test stops there.
  EXPECT_EQ(reject_hypotheses(std::array{0.026, 0.01, 0.04, 0.016}, 0.05),
            (std::vector<bool>{false, true, false, true}));
  EXPECT_EQ(reject_hypotheses(std::array{0.05}, 0.05), std::vector<bool>{true});
  EXPECT_TRUE(reject_hypotheses({}, 0.05).empty());
}

}  // namespace
}  // namespace tools
