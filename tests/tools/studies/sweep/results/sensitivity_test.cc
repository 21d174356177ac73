#include "tools/studies/sweep/results/sensitivity.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/tools/studies/sweep/results/made_sweep.h"

// Tests of `raywatt sweep sensitivity`.

namespace test {
namespace {

using tools::results::Results;
using tools::results::Sensitivity;

/// Path of a metric without noise.
Sensitivity of_steps(const MadeSweep& sweep) {
  const Results results = sweep.results();
  return find_sensitivity(results, "traversal_steps", std::vector<bool>(results.rows().size(), true));
}

const std::vector<std::string> kSizes = {"4 KiB", "8 KiB", "16 KiB"}, kCores = {"1", "2"};

/// A sweep with cycles = 100 + 10 s + 30 c, for sizes s = 0, 1, 2 and cores c = 0, 1.
double sum(std::size_t s, std::size_t c) { return 100 + 10.0 * static_cast<double>(s) + 30.0 * static_cast<double>(c); }

TEST(Sensitivity, OfASumIsThatOfItsTerms) {
  MadeSweep sweep;
  sweep.add_grid("size", kSizes, "cores", kCores, sum);
  const Sensitivity s = of_steps(sweep);
  EXPECT_EQ(s.points, 6U);
  EXPECT_TRUE(s.is_grid);
  EXPECT_DOUBLE_EQ(s.mean, 125);
  ASSERT_EQ(s.effects.size(), 2U);
  // Variances: 15^2 = 225 of the cores, 2/3 * 10^2 of the sizes.
  const double total = 225 + 200 / 3.0;
  EXPECT_EQ(s.effects[0].axis, "cores");
  EXPECT_NEAR(s.effects[0].share, 225 / total, 1e-12);
  EXPECT_NEAR(s.effects[0].range, 30 / 125.0, 1e-12);
  EXPECT_EQ(s.effects[1].axis, "size");
  EXPECT_EQ(s.effects[1].levels, kSizes);
  EXPECT_NEAR(s.effects[1].share, 200 / 3.0 / total, 1e-12);
  EXPECT_NEAR(s.effects[1].means[0], 115, 1e-9);
  EXPECT_NEAR(s.effects[1].means[2], 135, 1e-9);
  EXPECT_NEAR(s.share_of_interactions(), 0, 1e-12);
}

TEST(Sensitivity, OfAnExclusiveOrIsOnlyTogether) {
  MadeSweep sweep;
  sweep.add_grid("a", {"0", "1"}, "b", {"0", "1"}, [](std::size_t a, std::size_t b) { return a == b ? 10.0 : 20.0; });
  const Sensitivity s = of_steps(sweep);
  EXPECT_NEAR(s.effects[0].share, 0, 1e-12);
  EXPECT_NEAR(s.effects[1].share, 0, 1e-12);
  EXPECT_NEAR(s.share_of_interactions(), 1, 1e-12);
}

TEST(Sensitivity, PointsThatFailedDoNotBiasTheOthers) {
  MadeSweep sweep;
  sweep.add_grid("size", kSizes, "cores", kCores, sum);
  sweep.remove(5);  // the slowest point is missing; plain means of the others would hide the effect of both axes
  sweep.fail(5, "stuck");
  const Sensitivity s = of_steps(sweep);
  EXPECT_EQ(s.points, 5U);
  EXPECT_FALSE(s.is_grid);
  ASSERT_EQ(s.effects[0].axis, "cores");
  ASSERT_EQ(s.effects[1].levels, kSizes);
  EXPECT_NEAR(s.effects[0].means[1] - s.effects[0].means[0], 30, 1e-6);
  EXPECT_NEAR(s.effects[1].means[2] - s.effects[1].means[0], 20, 1e-6);
}

TEST(Sensitivity, SharesOfPointsThatAreNoGridComeToAllThatIsExplained) {
  MadeSweep sweep;  // part of a grid in which large values on one axis occur with small ones on the other
  for (std::size_t i = 0; i < 5; ++i) {
    for (std::size_t k = 0; i + k < 5; ++k) {
      const double value = 100 + 10.0 * static_cast<double>(i) + 12.0 * static_cast<double>(k);
      sweep.finish(sweep.add({{"a", std::to_string(i)}, {"b", std::to_string(k)}}), value);
    }
  }
  const Sensitivity s = of_steps(sweep);
  EXPECT_FALSE(s.is_grid);
  EXPECT_EQ(s.effects[0].axis, "b");
  EXPECT_NEAR(s.effects[0].share + s.effects[1].share, 1, 1e-6) << "nothing is left to be explained";
  EXPECT_NEAR(s.effects[1].share, 40.0 / 124, 1e-6);
}

TEST(Sensitivity, AxesThatMoveTogetherAreOne) {
  MadeSweep sweep;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const std::string cores = kCores[k];
      sweep.finish(sweep.add({{"size", kSizes[i]}, {"cores", cores}, {"channels", cores}}), sum(i, k));
    }
  }
  const Sensitivity s = of_steps(sweep);
  EXPECT_TRUE(s.is_grid);
  ASSERT_EQ(s.effects.size(), 2U);
  EXPECT_EQ(s.effects[0].axis, "cores + channels");
  EXPECT_EQ(s.effects[0].levels, (std::vector<std::string>{"1 / 1", "2 / 2"}));
}

TEST(Sensitivity, ValuesThatNoTwoPointsShareAreTakenTogether) {
  MadeSweep sweep;  // a random subset of two wide ranges; the second has no effect
  for (std::uint64_t i = 0; i < 100; ++i) {
    const std::uint64_t a = sim::hash(i, 1) % 100'000, b = sim::hash(i, 2) % 100'000;
    sweep.finish(sweep.add({{"a", std::to_string(a)}, {"b", std::to_string(b)}}), 1000 + static_cast<double>(a));
  }
  const Sensitivity s = of_steps(sweep);
  EXPECT_FALSE(s.is_grid);
  EXPECT_EQ(s.effects[0].axis, "a");
  EXPECT_EQ(s.effects[0].levels.size(), 6U);
  EXPECT_GT(s.effects[0].share, 0.9);
  EXPECT_LT(s.effects[1].share, 0.05);
  EXPECT_TRUE(std::ranges::is_sorted(s.effects[0].means));
}

TEST(Sensitivity, OfWhatNeverChangesIsNone) {
  MadeSweep sweep;
  sweep.add_grid("size", kSizes, "cores", kCores, [](std::size_t, std::size_t) { return 5.0; });
  const Sensitivity s = of_steps(sweep);
  EXPECT_EQ(s.effects[0].share, 0);
  EXPECT_EQ(s.effects[0].range, 0);
  EXPECT_EQ(s.share_of_interactions(), 0);
}

TEST(Sensitivity, IsShownWithTheLargestFirst) {
  MadeSweep sweep;
  sweep.add_grid("size", kSizes, "cores", kCores, sum);
  EXPECT_EQ(sensitivity_text(sweep.results(), {"traversal_steps"}, {}),
            "traversal_steps: mean 125 of 6 points\n\n"
            "axis           levels  lowest mean     at  highest mean      at   range  share of variance\n"
            "-------------  ------  -----------  -----  ------------  ------  ------  -----------------\n"
            "cores               2          110      1           140       2  24.0 %             77.1 %\n"
            "size                3          115  4 KiB           135  16 KiB  16.0 %             22.9 %\n"
            "only together                                                                        0.0 %\n");
}

/// Two axes, one without effect; each point has the mean and deviation of its replicates.
struct NoisyGrid : MadeSweep {
  explicit NoisyGrid(double deviation, double of_noise = 1) {
    for (std::size_t s = 0; s < 6; ++s) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double mean = 1000 + 100.0 * static_cast<double>(c) + of_noise * draw(s, c);
        auto report = minimal_report(mean);
        report["totals"]["replicates"] = {{"count", 4},
                                          {"figures", {{"cycles", {{"mean", mean}, {"deviation", deviation}}}}}};
        finish(add({{"size", std::to_string(s)}, {"cores", std::to_string(c)}}), report);
      }
    }
  }
  /// Returns a random number between -1 and 1.
  static double draw(std::size_t s, std::size_t c) { return static_cast<double>(sim::hash(s, c, 5) % 2001) / 1000 - 1; }
};

TEST(Sensitivity, TakesOffWhatNoiseExplainsAndNamesIt) {
  const NoisyGrid sweep(100, 87);  // standard deviation of the mean: 50, as of a uniform distribution from -87 to 87
  const Results results = sweep.results();
  const Sensitivity s = find_sensitivity(results, "cycles", std::vector<bool>(results.rows().size(), true));
  ASSERT_EQ(s.effects[0].axis, "cores");
  EXPECT_GT(s.effects[0].low, 0.5);
  EXPECT_LT(s.effects[1].share, 0.1);
  EXPECT_EQ(s.effects[1].low, 0) << "it may do nothing";
  EXPECT_GT(s.effects[1].high, 0.01);
  EXPECT_GT(s.noise, 0.05);
  double sum = s.noise + s.share_of_interactions();
  for (const auto& effect : s.effects) {
    sum += effect.share;
    EXPECT_LE(effect.low, effect.share);
    EXPECT_GE(effect.high, effect.share);
  }
  EXPECT_NEAR(sum, 1, 1e-12);
  const std::string text = sensitivity_text(results, {"cycles"}, {});
  EXPECT_SAYS(text, "noise measured by 4 replicates per point\n");
  EXPECT_SAYS(text, "\nnoise ");
}

TEST(Sensitivity, OfQuietPointsHasNarrowIntervals) {
  const NoisyGrid sweep(0.2);
  const Results results = sweep.results();
  const Sensitivity s = find_sensitivity(results, "cycles", std::vector<bool>(results.rows().size(), true));
  EXPECT_GT(s.effects[0].low, 0.999);
  EXPECT_LT(s.noise, 1e-4);
}

TEST(Sensitivity, SaysWhatHasNoResultAndWhatIsNoNumber) {
  MadeSweep sweep;
  sweep.finish(sweep.add({{"a", "1"}}), 1);
  sweep.add({{"a", "2"}});
  const Results results = sweep.results();
  EXPECT_SAYS(sensitivity_text(results, {}, {}), "1 of 2 points have no result: 1 missing");
  EXPECT_THROW(sensitivity_text(results, {"limiter"}, {}), sim::InputError);
  EXPECT_THROW(sensitivity_text(results, {"cycles"}, {"a=2"}), sim::InputError);
}

}  // namespace
}  // namespace test
