#include "tools/sampling/frame_sample.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "sim/hash.h"

namespace tools {
namespace {

/// A sequence of frames with smooth counts: the camera passes a dense part of the scene.
std::vector<FrameCounts> smooth_counts(std::uint32_t frames) {
  std::vector<FrameCounts> counts(frames);
  for (std::uint32_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) / frames, dense = std::exp(-40 * (t - 0.6) * (t - 0.6));
    counts[i].primary = 1000;
    counts[i].shadow = 800 + 200 * std::sin(9 * t);
    counts[i].visits = 2e4 + 5e4 * dense + 1e4 * t;
    counts[i].tests = 5e3 + 2e4 * dense;
    counts[i].tree_lines = 4e3 + 3e3 * std::sin(20 * t);
  }
  return counts;
}

double noise_of(std::uint64_t frame) { return sim::hash_to_unit_float(sim::hash(77, frame)) - 0.5; }

/// Returns the cycles of each frame: not linear in the counts, with noise that no count shows.
std::vector<double> made_up_cycles(const std::vector<FrameCounts>& counts) {
  std::vector<double> cycles;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const FrameCounts& c = counts[i];
    const double work = 1.2 * c.visits + 2 * c.tests + 0.5 * c.tree_lines + 1e-5 * c.visits * c.visits;
    cycles.push_back(work * (1 + 0.08 * noise_of(i)));
  }
  return cycles;
}

std::vector<double> seen_in(const FrameSample& sample, const std::vector<double>& values) {
  std::vector<double> seen;
  for (const std::uint32_t frame : sample.chosen()) seen.push_back(values[frame]);
  return seen;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

std::vector<FrameCounts> two_kinds() {
  std::vector<FrameCounts> counts(10);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    counts[i].primary = 100;
    counts[i].visits = i % 3 == 0 ? 5000 : 700;
    counts[i].shadow = i % 3 == 0 ? 20 : 90;
  }
  return counts;
}

TEST(FrameSample, FindsTheTwoKindsOfFramesAndItsTotalsAreExact) {
  const FrameSample sample(two_kinds(), 0, 1);
  EXPECT_EQ(sample.clusters().sizes, (std::vector<std::uint32_t>{4, 6}));
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(sample.clusters().of_frame[i], i % 3 == 0 ? 0U : 1U);
  EXPECT_EQ(sample.chosen().size(), 4U);
  std::vector<double> values;
  for (std::size_t i = 0; i < 10; ++i) values.push_back(i % 3 == 0 ? 1234.5 : 87.25);
  const Interval total = sample.total(seen_in(sample, values));
  EXPECT_NEAR(total.estimate, sum(values), 1e-9);
  EXPECT_NEAR(total.half_width(), 0, 1e-9);
}

TEST(FrameSample, HasNoMoreClustersThanDifferentFrames) {
  EXPECT_EQ(FrameSample(two_kinds(), 7, 1).clusters().sizes.size(), 2U);
  const FrameSample equal(std::vector<FrameCounts>(5), 3, 1);
  EXPECT_EQ(equal.clusters().sizes, (std::vector<std::uint32_t>{5}));
  EXPECT_EQ(equal.weights(), (std::vector<double>{2.5, 2.5}));
}

TEST(FrameSample, DependsOnTheDrawOnly) {
  const std::vector<FrameCounts> counts = smooth_counts(200);
  const FrameSample a(counts, 6, 3), b(counts, 6, 3), c(counts, 6, 4);
  EXPECT_EQ(a.chosen(), b.chosen());
  EXPECT_EQ(a.weights(), b.weights());
  EXPECT_NE(a.chosen(), c.chosen());
}

TEST(FrameSample, WeightsAddUpToTheFramesAndTotalsOfCountsAreNearlyExact) {
  const std::vector<FrameCounts> counts = smooth_counts(300);
  const FrameSample sample(counts, 8, 1);
  EXPECT_EQ(sample.clusters().sizes.size(), 8U);
  EXPECT_EQ(sample.chosen().size(), 16U);
  EXPECT_NEAR(sum(sample.weights()), 300, 1e-6);
  std::vector<double> visits;
  for (const FrameCounts& c : counts) visits.push_back(c.visits);
  EXPECT_NEAR(sample.total(seen_in(sample, visits)).estimate, sum(visits), 0.01 * sum(visits));
}

TEST(FrameSample, IntervalsContainTheTruthInNineOfTenDraws) {
  const std::vector<FrameCounts> counts = smooth_counts(300);
  const std::vector<double> cycles = made_up_cycles(counts);
  int inside = 0;
  double width = 0;
  constexpr int kDraws = 100;
  for (std::uint64_t draw = 1; draw <= kDraws; ++draw) {
    const FrameSample sample(counts, 8, draw);
    const Interval total = sample.total(seen_in(sample, cycles));
    inside += std::abs(total.estimate - sum(cycles)) <= total.half_width() ? 1 : 0;
    width += total.half_width() / total.estimate / kDraws;
  }
  EXPECT_GE(inside, 90);
  EXPECT_LT(width, 0.04) << "intervals that are too wide contain everything";
  EXPECT_GT(width, 0.005) << "the noise of a frame is 2.3 %";
}

TEST(FrameSample, AddedFramesNarrowTheIntervalAndAllFramesLeaveNone) {
  const std::vector<FrameCounts> counts = smooth_counts(100);
  const std::vector<double> cycles = made_up_cycles(counts);
  FrameSample sample(counts, 5, 1);
  const std::vector<std::uint32_t> first = sample.chosen();
  const double before = sample.total(seen_in(sample, cycles)).half_width();
  sample.add_frames(20, seen_in(sample, cycles));
  EXPECT_EQ(sample.chosen().size(), 30U);
  EXPECT_TRUE(std::ranges::includes(sample.chosen(), first));
  EXPECT_LT(sample.total(seen_in(sample, cycles)).half_width(), before);
  sample.add_frames(1000, seen_in(sample, cycles));
  EXPECT_TRUE(sample.has_all_frames());
  const Interval all = sample.total(seen_in(sample, cycles));
  EXPECT_NEAR(all.estimate, sum(cycles), 1e-9 * sum(cycles));
  EXPECT_EQ(all.half_width(), 0);
}

TEST(FrameSample, ErrorsOfFramesWidenTheInterval) {
  const FrameSample sample(two_kinds(), 2, 1);
  const std::vector<double> values(4, 100);
  const Interval total = sample.total(values, std::vector<Interval>(4, {100, 3, 1}));
  EXPECT_NEAR(total.random, 3 * std::sqrt(2 * 2 * 2 + 2 * 3 * 3), 1e-9);
  EXPECT_NEAR(total.systematic, 10, 1e-9);
}

}  // namespace
}  // namespace tools
