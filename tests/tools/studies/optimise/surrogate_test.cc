#include "tools/studies/optimise/surrogate.h"

#include <cmath>

#include <gtest/gtest.h>

// Figures estimated from some of their values.

namespace test {
namespace {

using namespace tools::optimise;

const std::vector<AxisShape> kLine = {{21, true}};

/// f at every `step`-th of the 21 points.
Surrogate::Values sampled(const std::function<double(double)>& f, std::uint32_t step) {
  Surrogate::Values values;
  for (std::uint32_t i = 0; i < 21; i += step) values[{i}] = f(i);
  return values;
}

TEST(GaussianProcess, IsExactWhereItHasSeen) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 3, 0}, {{5}, -1, 0}, {{20}, 7, 0}});
  EXPECT_NEAR(process.at({0}).mean, 3, 0.5);
  EXPECT_NEAR(process.at({20}).mean, 7, 0.5);
  EXPECT_LT(process.at({5}).deviation, process.at({12}).deviation) << "it knows less between";
}

TEST(GaussianProcess, FindsOutThatAnAxisDoesNotMatter) {
  const std::vector<AxisShape> plane = {{6, true}, {6, true}};
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 6; ++i) {
    for (const std::uint32_t j : {i % 3, i % 3 + 3}) seen.push_back({{i, j}, std::sin(i), 0});
  }
  GaussianProcess process(plane);
  process.fit(seen);
  for (std::uint32_t i = 0; i < 6; ++i) EXPECT_NEAR(process.at({i, 2}).mean, std::sin(i), 0.1) << i;
}

TEST(GaussianProcess, BelievesAsIfItHadSeen) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 0, 0}, {{8}, 1, 0}, {{20}, 0, 0}});
  process.believe({14}, 5);
  EXPECT_NEAR(process.at({14}).mean, 5, 0.1);
  EXPECT_LT(process.at({14}).deviation, 0.4);
}

TEST(GaussianProcess, SmoothsWhatErrorsBlur) {
  // A wave about 3: seen exactly it is followed, seen through errors as large as it is it may be noise alone.
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
    EXPECT_NEAR(believing.at({i}).mean, 3 + wave, 0.1) << i;
    EXPECT_LT(std::abs(doubting.at({i}).mean - 3), 0.6 * std::abs(wave)) << i;
  }
}

TEST(GaussianProcess, NoisePromisesNoFigure) {
  // A slope with one lucky point far above it.
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 21; i += 2) seen.push_back({{i}, 0.1 * i + (i == 10 ? 1.5 : 0), 0.25});
  GaussianProcess process(kLine);
  process.fit(seen);
  EXPECT_LT(process.at({10}).mean, 1.4) << "of 1 on the slope and 2.5 seen";
  EXPECT_LT(process.at({11}).mean + process.at({11}).deviation, 2.2);
}

TEST(GaussianProcess, ErrorsCountInTheFiguresOwnUnit) {
  GaussianProcess small(kLine), large(kLine);
  std::vector<Observation> seen, scaled;
  for (std::uint32_t i = 0; i < 21; i += 4) {
    const double value = std::sin(0.4 * i) + (i % 8 == 0 ? 0.2 : -0.2);
    seen.push_back({{i}, value, 0.04});
    scaled.push_back({{i}, 1000 * value, 40'000});
  }
  small.fit(seen);
  large.fit(scaled);
  for (std::uint32_t i = 0; i < 21; ++i) EXPECT_NEAR(large.at({i}).mean, 1000 * small.at({i}).mean, 1e-3) << i;
}

TEST(GaussianProcess, TakesValuesThatAreAllTheSame) {
  GaussianProcess process(kLine);
  process.fit({{{0}, 2, 0}, {{9}, 2, 0}, {{20}, 2, 0}});
  EXPECT_NEAR(process.at({4}).mean, 2, 1e-9);
  EXPECT_LT(process.at({4}).deviation, 1e-3);
}

TEST(GaussianProcess, KeepsValuesWithoutAnOrderApart) {
  const std::vector<AxisShape> names = {{12, false}};
  std::vector<Observation> seen;
  for (std::uint32_t i = 0; i < 11; ++i) seen.push_back({{i}, i % 2 == 0 ? 1.0 : -1.0, 0});
  GaussianProcess process(names);
  process.fit(seen);
  EXPECT_NEAR(process.at({11}).mean, 1.0 / 11, 0.2) << "nothing follows for another name but the mean";
}

TEST(Surrogate, EstimatesProductsByTheirLogarithms) {
  const auto f = [](double x) { return std::exp(0.5 * x); };
  Surrogate surrogate(kLine);
  surrogate.fit(sampled(f, 4), {});
  for (std::uint32_t i = 0; i < 21; ++i) {
    EXPECT_NEAR(surrogate.inverse(surrogate.at({i}).mean) / f(i), 1, 0.02) << i;
  }
}

TEST(Surrogate, EstimatesSumsAsTheyAre) {
  const auto f = [](double x) { return 40 - 2 * x; };
  Surrogate surrogate(kLine);
  surrogate.fit(sampled(f, 4), {});
  EXPECT_NEAR(surrogate.inverse(surrogate.at({13}).mean), f(13), 0.3);
  const auto negative = [](double x) { return x - 10; };
  surrogate.fit(sampled(negative, 4), {});
  EXPECT_NEAR(surrogate.inverse(surrogate.at({13}).mean), 3, 0.3);
}

TEST(Surrogate, LearnsTheBiasOfFirstLooks) {
  const auto f = [](double x) { return 10 + std::sin(x / 2); };
  const auto look = [&](double x) { return f(x) + 0.7; };
  Surrogate blind(kLine), helped(kLine);
  blind.fit(sampled(f, 10), {});
  helped.fit(sampled(f, 10), sampled(look, 2));
  double blind_error = 0, helped_error = 0;
  for (std::uint32_t i = 0; i < 21; ++i) {
    blind_error = std::max(blind_error, std::abs(blind.inverse(blind.at({i}).mean) - f(i)));
    helped_error = std::max(helped_error, std::abs(helped.inverse(helped.at({i}).mean) - f(i)));
  }
  EXPECT_GT(blind_error, 0.5);
  EXPECT_LT(helped_error, 0.15);
}

}  // namespace
}  // namespace test
