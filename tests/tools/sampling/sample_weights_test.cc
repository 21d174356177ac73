#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "sim/hash.h"
#include "tools/sampling/tile_sampling.h"

// Tests of totals estimated from samples: exact cases, and the coverage of the confidence interval.

namespace tools {
namespace {

double uniform(std::uint64_t trial, std::uint64_t index, std::uint64_t of) {
  return static_cast<double>(sim::hash_to_unit_float(sim::hash(trial, index, of)));
}

/// Returns an approximately normal random number of variance 1.
double noise(std::uint64_t trial, std::uint64_t index) {
  double sum = -6;
  for (std::uint64_t i = 0; i < 12; ++i) sum += uniform(trial, index, 100 + i);
  return sum;
}

/// A population of parts. Some are sampled, with probability proportional to size.
struct Drawn {
  SamplePart whole{0, {0, 0}};
  std::vector<SamplePart> parts;
  std::vector<double> observed;
  double truth = 0;
};

/// The quantity to estimate: for each part 3 per size, 2 and 5 per trait, and random noise of `unknown` per size.
Drawn draw(std::uint64_t trial, std::size_t count, double unknown) {
  constexpr std::size_t kAll = 2000;
  std::vector<SamplePart> all;
  std::vector<double> takes, before(1);
  Drawn d;
  for (std::size_t i = 0; i < kAll; ++i) {
    const double size = 0.2 + uniform(trial, i, 1);
    const SamplePart part{size, {size * uniform(trial, i, 2), size * uniform(trial, i, 3)}};
    takes.push_back(3 * size + 2 * part.traits[0] + 5 * part.traits[1] + unknown * size * noise(trial, i));
    d.truth += takes.back();
    d.whole.size += size;
    for (std::size_t j = 0; j < 2; ++j) d.whole.traits[j] += part.traits[j];
    before.push_back(d.whole.size);
    all.push_back(part);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const double at = d.whole.size * (static_cast<double>(k) + uniform(trial, k, 4)) / static_cast<double>(count);
    const auto i = static_cast<std::size_t>(std::upper_bound(before.begin(), before.end(), at) - before.begin() - 1);
    d.parts.push_back(all[i]);
    d.observed.push_back(takes[i]);
  }
  return d;
}

TEST(SampleWeights, QuantitiesLinearInTheTraitsAreExact) {
  const Drawn d = draw(1, 12, 0);
  const SampleWeights weights(d.parts, d.whole, 0);
  EXPECT_NEAR(weights.total(d.observed) / d.truth, 1, 1e-6);
  EXPECT_LT(weights.half_width(d.observed) / d.truth, 1e-6);
  EXPECT_NEAR(weights.degrees_of_freedom(), 12 - 3, 1e-6) << "a mean and two slopes are fitted";
}

TEST(SampleWeights, TheIntervalHoldsTheTruthNineteenTimesInTwenty) {
  for (const double ridge : {0.0, 0.2}) {
    int held = 0;
    constexpr int kTrials = 1000;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Drawn d = draw(static_cast<std::uint64_t>(trial), 24, 1.5);
      const SampleWeights weights(d.parts, d.whole, ridge);
      held += std::abs(weights.total(d.observed) - d.truth) <= weights.half_width(d.observed);
    }
    EXPECT_GE(held, kTrials * 93 / 100) << "ridge " << ridge;
    EXPECT_LE(held, kTrials * 97 / 100) << "ridge " << ridge;
  }
}

TEST(SampleWeights, TraitsMakeTheIntervalNarrower) {
  const Drawn d = draw(3, 24, 0.3);
  std::vector<SamplePart> blind;
  for (const SamplePart& part : d.parts) blind.push_back({part.size, {}});
  const SampleWeights with(d.parts, d.whole, 0.05), without(blind, {d.whole.size, {}}, 0.05);
  EXPECT_LT(3 * with.half_width(d.observed), without.half_width(d.observed));
}

TEST(SampleWeights, WhatAddsUpInPartsAddsUpInTotals) {
  const Drawn a = draw(5, 16, 1), b = draw(6, 16, 1);
  const SampleWeights weights(a.parts, a.whole, 0.2);
  std::vector<double> sum;
  for (std::size_t i = 0; i < a.observed.size(); ++i) sum.push_back(a.observed[i] + b.observed[i]);
  EXPECT_NEAR(weights.total(sum), weights.total(a.observed) + weights.total(b.observed), 1e-6);
}

TEST(SampleWeights, ATraitInWhichPartsDoNotDifferChangesNothing) {
  Drawn d = draw(7, 16, 1);
  const SampleWeights before(d.parts, d.whole, 0.2);
  for (SamplePart& part : d.parts) part.traits.push_back(0);
  d.whole.traits.push_back(0);
  const SampleWeights after(d.parts, d.whole, 0.2);
  EXPECT_DOUBLE_EQ(before.total(d.observed), after.total(d.observed));
  EXPECT_DOUBLE_EQ(before.half_width(d.observed), after.half_width(d.observed));
}

}  // namespace
}  // namespace tools
