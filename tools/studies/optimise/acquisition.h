#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/studies/optimise/surrogate.h"

// Closed-form acquisition functions as logarithms. Plain values underflow far from the best point, and all points tie
// (Ament et al., Unexpected Improvements to Expected Improvement, 2023, https://arxiv.org/abs/2310.20708).

namespace tools::optimise {

/// Below this value erfc() is close to underflow, and the first terms of the asymptotic series have five exact digits.
constexpr double kTail = -30;
inline const double kLogSqrt2Pi = 0.5 * std::log(2 * std::numbers::pi);

/// Returns the logarithm of the standard normal distribution function.
inline double log_normal_cdf(double z) {
  if (z < kTail) return -0.5 * z * z - kLogSqrt2Pi - std::log(-z) + std::log1p(-1 / (z * z));
  const double tail = 0.5 * std::erfc(std::abs(z) / std::numbers::sqrt2);
  return z < 0 ? std::log(tail) : std::log1p(-tail);
}

/// Returns the logarithm of the probability that a value is above (or below) a limit.
inline double log_probability(const Estimate& value, double limit, bool is_above) {
  const double distance = is_above ? value.mean - limit : limit - value.mean;
  if (value.deviation > 0) return log_normal_cdf(distance / value.deviation);
  return distance > 0 ? 0 : -std::numeric_limits<double>::infinity();
}

/// Returns the logarithm of the expectation of max(0, value - best).
inline double log_expected_gain(const Estimate& value, double best) {
  const double distance = value.mean - best;
  if (!(value.deviation > 0)) return std::log(std::max(distance, 0.0));
  const double z = distance / value.deviation, log_density = -0.5 * z * z - kLogSqrt2Pi;
  if (z < kTail) return std::log(value.deviation) + log_density - 2 * std::log(-z) + std::log1p(-3 / (z * z));
  const double below = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return std::log(value.deviation) + std::log(std::exp(log_density) + z * below);
}

}  // namespace tools::optimise
