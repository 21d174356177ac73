#include "tools/studies/optimise/surrogate.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "sim/hash.h"

// Tests of the surrogate model, which estimates a metric from some of its values.

namespace test {
namespace {

using namespace tools::optimise;

const std::vector<AxisShape> kLine = {{21, true}};

/// Returns the values of f at every `step`-th of the 21 points.
Surrogate::Values sampled(const std::function<double(double)>& f, std::uint32_t step) {
  Surrogate::Values values;
  for (std::uint32_t i = 0; i < 21; i += step) values[{i}] = f(i);
  return values;
}

TEST(GaussianProcess, IsExactAtObservedPoints) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 3, 0}, {{5}, -1, 0}, {{20}, 7, 0}});
  EXPECT_NEAR(process.estimate_at({0}).mean, 3, 0.5);
  EXPECT_NEAR(process.estimate_at({20}).mean, 7, 0.5);
  EXPECT_LT(process.estimate_at({5}).deviation, process.estimate_at({12}).deviation) << "it knows less between";
}

TEST(GaussianProcess, DetectsAnAxisWithoutEffect) {
  const std::vector<AxisShape> plane = {{6, true}, {6, true}};
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 6; ++i) {
    for (const std::uint32_t j : {i % 3, i % 3 + 3}) seen.push_back({{i, j}, std::sin(i), 0});
  }
  GaussianProcess process(plane);
  process.fit(seen);
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_NEAR(process.estimate_at({i, 2}).mean, std::sin(i), 0.1) << i;
}

TEST(GaussianProcess, TreatsPseudoObservationsAsObserved) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 0, 0}, {{8}, 1, 0}, {{20}, 0, 0}});
  process.add_pseudo_observation({14}, 5);
  EXPECT_NEAR(process.estimate_at({14}).mean, 5, 0.1);
  EXPECT_LT(process.estimate_at({14}).deviation, 0.4);
}

TEST(GaussianProcess, SmoothsValuesWithErrors) {
  // A wave around 3. The model follows exact values; with errors as large as the wave it assumes noise.
  std::vector<Observation> sure, blurred;
  for (std::uint32_t i = 0; i < 21; i += 2) {
    const double value = 3 + std::sin(0.5 * i);
    sure.push_back({{i}, value, 0});
    blurred.push_back({{i}, value, 1});
  }
  GaussianProcess believing(kLine), doubting(kLine);
  believing.fit(sure);
  doubting.fit(blurred);
  for (const std::uint32_t i : {4U, 9U, 16U}) {
    const double wave = std::sin(0.5 * i);
    EXPECT_NEAR(believing.estimate_at({i}).mean, 3 + wave, 0.1) << i;
    EXPECT_LT(std::abs(doubting.estimate_at({i}).mean - 3), 0.6 * std::abs(wave)) << i;
  }
}

TEST(GaussianProcess, AssumesSmallerErrorsThanBoundsIfValuesShowIt) {
  std::vector<Observation> slope;
  for (std::uint32_t i = 0; i < 21; i += 2) slope.push_back({{i}, 0.1 * i, 0.25});
  GaussianProcess stated(kLine), bounded(kLine);
  stated.fit(slope);
  bounded.fit(slope, true);
  for (const std::uint32_t i : {1U, 19U}) {
    EXPECT_GT(std::abs(stated.estimate_at({i}).mean - 0.1 * i), 0.1) << i;
    EXPECT_NEAR(bounded.estimate_at({i}).mean, 0.1 * i, 0.05) << i;
    EXPECT_LT(bounded.estimate_at({i}).deviation, 0.5 * stated.estimate_at({i}).deviation) << i;
  }
}

TEST(GaussianProcess, DoesNotLowerEstimatesByNoise) {
  // A slope with one point far above it.
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 21; i += 2) seen.push_back({{i}, 0.1 * i + (i == 10 ? 1.5 : 0), 0.25});
  GaussianProcess process(kLine);
  process.fit(seen);
  EXPECT_LT(process.estimate_at({10}).mean, 1.4) << "of 1 on the slope and 2.5 seen";
  EXPECT_LT(process.estimate_at({11}).mean + process.estimate_at({11}).deviation, 2.2);
}

TEST(GaussianProcess, CoversTheTruthInNineteenOfTwentyIntervals) {
  // Curved surfaces over 625 points, 60 of them observed with errors of a fifth to three times the deviation.
  const std::vector<AxisShape> space(4, AxisShape{5, true});
  std::size_t held = 0, asked = 0;
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const auto uniform = [&](std::uint64_t a, std::uint64_t b) {
      return double{sim::hash_to_unit_float(sim::hash(seed, a, b))};
    };
    const auto truth = [&](const Choice& c) {
      return (2 * uniform(1, 0) - 1) * c[0] / 4.0 + (2 * uniform(2, 0) - 1) * (c[1] / 4.0) * (c[1] / 4.0) +
             uniform(3, 0) * c[0] * c[1] / 16.0;
    };
    const double error = 0.3 * std::array{0.2, 1.0, 3.0}[seed % 3];
    const auto point = [](std::size_t i) {
      const auto n = static_cast<std::uint32_t>(i * 251 % 625);  // all points, in another order
      return Choice{n % 5, n / 5 % 5, n / 25 % 5, n / 125};
    };
    std::vector<Observation> seen;
    for (std::size_t i = 0; i < 60; ++i) {
      double normal = -6;  // twelve uniform draws have the variance of one
      for (std::uint64_t k = 0; k < 12; ++k) normal += uniform(10 + i, k);
      seen.push_back({point(i), truth(point(i)) + error * normal, error * error});
    }
    GaussianProcess process(space);
    process.fit(seen);
    for (std::size_t i = 0; i < 625; ++i) {
      const Estimate e = process.estimate_at(point(i));
      held += std::abs(e.mean - truth(point(i))) <= 1.96 * e.deviation ? 1 : 0;
      asked += 1;
    }
  }
  const double share = static_cast<double>(held) / static_cast<double>(asked);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.995) << "nor are they so wide that they always hold";
}

TEST(GaussianProcess, TakesErrorsInTheUnitOfTheMetric) {
  GaussianProcess small(kLine), large(kLine);
  std::vector<Observation> seen, scaled;
  for (std::uint32_t i = 0; i < 21; i += 4) {
    const double value = std::sin(0.4 * i) + (i % 8 == 0 ? 0.2 : -0.2);
    seen.push_back({{i}, value, 0.04});
    scaled.push_back({{i}, 1000 * value, 40'000});
  }
  small.fit(seen);
  large.fit(scaled);
  for (std::uint32_t i = 0; i < 21; ++i)
    EXPECT_NEAR(large.estimate_at({i}).mean, 1000 * small.estimate_at({i}).mean, 1e-3) << i;
}

TEST(GaussianProcess, AcceptsEqualValues) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 2, 0}, {{9}, 2, 0}, {{20}, 2, 0}});
  EXPECT_NEAR(process.estimate_at({4}).mean, 2, 1e-9);
  EXPECT_LT(process.estimate_at({4}).deviation, 1e-3);
}

TEST(GaussianProcess, SeparatesUnorderedValues) {
  const std::vector<AxisShape> names = {{12, false}};
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 11; ++i) seen.push_back({{i}, i % 2 == 0 ? 1.0 : -1.0, 0});
  GaussianProcess process(names);
  process.fit(seen);
  EXPECT_NEAR(process.estimate_at({11}).mean, 1.0 / 11, 0.2) << "nothing follows for another name but the mean";
}

TEST(Surrogate, EstimatesProductsByTheirLogarithms) {
  const auto f = [](double x) { return std::exp(0.5 * x); };
  Surrogate surrogate(kLine);
  surrogate.fit(sampled(f, 4), {});
  for (std::uint32_t i = 0; i < 21; ++i) {
    EXPECT_NEAR(surrogate.from_model_scale(surrogate.estimate_at({i}).mean) / f(i), 1, 0.02) << i;
  }
}

TEST(Surrogate, EstimatesNoLogarithmsIfForbidden) {
  Surrogate surrogate(kLine);
  surrogate.forbid_log();
  surrogate.fit(sampled([](double x) { return std::exp(0.5 * x); }, 4), {});
  EXPECT_EQ(surrogate.to_model_scale(-1), -1) << "a limit of 0 or less has a value";
  EXPECT_GT(surrogate.estimate_at({2}).deviation, 0);
}

TEST(Surrogate, EstimatesSumsWithoutLogarithms) {
  const auto f = [](double x) { return 40 - 2 * x; };
  Surrogate surrogate(kLine);
  surrogate.fit(sampled(f, 4), {});
  EXPECT_NEAR(surrogate.from_model_scale(surrogate.estimate_at({13}).mean), f(13), 0.3);
  const auto negative = [](double x) { return x - 10; };
  surrogate.fit(sampled(negative, 4), {});
  EXPECT_NEAR(surrogate.from_model_scale(surrogate.estimate_at({13}).mean), 3, 0.3);
}

TEST(Surrogate, LearnsTheBiasOfFirstLooks) {
  const auto f = [](double x) { return 10 + std::sin(x / 2); };
  const auto look = [&](double x) { return f(x) + 0.7; };
  Surrogate blind(kLine), helped(kLine);
  blind.fit(sampled(f, 10), {});
  helped.fit(sampled(f, 10), sampled(look, 2));
  double blind_error = 0, helped_error = 0;
  for (std::uint32_t i = 0; i < 21; ++i) {
    blind_error = std::max(blind_error, std::abs(blind.from_model_scale(blind.estimate_at({i}).mean) - f(i)));
    helped_error = std::max(helped_error, std::abs(helped.from_model_scale(helped.estimate_at({i}).mean) - f(i)));
  }
  EXPECT_GT(blind_error, 0.5);
  EXPECT_LT(helped_error, 0.15);
}

}  // namespace
}  // namespace test
