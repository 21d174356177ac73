#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

using sweep::Choice;

/// The shape of an axis of the search space.
struct AxisShape {
  std::uint32_t values = 1;
  bool ordered = true;  ///< neighbouring values are similar; false: all values are equally far from each other
};

/// The estimate of a value that has not been simulated: a normal distribution.
struct Estimate {
  double mean = 0, deviation = 0;
};

/// A simulated value at a point.
struct Observation {
  Choice at;
  double value = 0;
  double variance = 0;  ///< variance of the value's noise, which is independent of other points; 0: exact
};

/// Estimates a function of the axes from some of its values by Kriging, with a constant mean and a Matern 5/2
/// covariance with a length per axis (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, ch. 2, 4,
/// 5). Lengths and roughness maximise the likelihood, by hill climbing from the previous fit.
class GaussianProcess {
 public:
  explicit GaussianProcess(std::span<const AxisShape> axes);
  ~GaussianProcess();
  GaussianProcess(GaussianProcess&& other) noexcept;

  /// Fits the model to at least one observation and returns the log likelihood per observation.
  /// `errors_are_upper_bounds`: the fit may reduce all stated errors by the same factor.
  double fit(std::vector<Observation> observations, bool errors_are_upper_bounds = false);
  Estimate estimate_at(const Choice& point) const;
  /// Adds an estimated value as if it had been simulated (Kriging believer).
  void add_pseudo_observation(const Choice& point, double value);

 private:
  struct Solution;

  double covariance_of(const Choice& a, const Choice& b) const;
  Solution solve_model(std::span<const Observation> observations);
  /// Solves the equations for a given variance of the process, relative to which the errors count.
  Solution solve_model(std::span<const Observation> observations, double variance);

  std::vector<AxisShape> axes_;
  std::vector<int> lengths_;  ///< one per axis, as powers of kStep
  int roughness_ = 0;         ///< index into kNuggets
  int error_share_ = 0;       ///< index into kErrorShares
  std::vector<Observation> observations_;
  double shift_ = 0, scale_ = 1;  ///< the model is fitted to (value - shift) / scale
  std::vector<double> inverse_lengths_;
  std::unique_ptr<Solution> solution_;
};

/// Estimates a metric at points that have not been simulated. Positive metrics are modelled by their logarithm if that
/// has a higher likelihood. Approximate first looks are corrected by their mean error and used as noisy observations.
class Surrogate {
 public:
  explicit Surrogate(std::span<const AxisShape> axes);

  /// Fits the model to at least one simulated value, and to the values of first looks. `errors`: standard errors of
  /// noisy simulated values; `errors_are_upper_bounds`: they are assumed upper bounds, not measured.
  using Values = std::map<Choice, double>;
  void fit(const Values& simulated, const Values& looks, const Values& errors = {},
           bool errors_are_upper_bounds = false);
  /// Excludes the logarithmic model, for a metric with a limit of 0 or less.
  void forbid_log() { may_be_log_ = false; }
  /// Returns the estimate at a point, as a logarithm if the logarithm of the metric is modelled.
  Estimate estimate_at(const Choice& point) const { return active_process().estimate_at(point); }
  double from_model_scale(double value) const;
  double to_model_scale(double value) const;
  void add_pseudo_observation(const Choice& point, double value) {
    (is_log_ ? log_ : plain_).add_pseudo_observation(point, value);
  }

 private:
  const GaussianProcess& active_process() const { return is_log_ ? log_ : plain_; }
  std::vector<Observation> make_observations(const Values& simulated, const Values& looks, const Values& errors) const;

  GaussianProcess plain_, log_;
  bool may_be_log_ = true, is_log_ = false;
};

}  // namespace tools::optimise

// Closed-form acquisition functions as logarithms. Without logarithms the values underflow far from the best point, and
// all points tie (Ament et al., Unexpected Improvements to Expected Improvement, 2023,
// https://arxiv.org/abs/2310.20708).

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

/// Returns the logarithm of the probability that an estimated value is above a limit, or below it if not `is_above`.
inline double log_probability(const Estimate& value, double limit, bool is_above) {
  const double distance = is_above ? value.mean - limit : limit - value.mean;
  if (value.deviation > 0) return log_normal_cdf(distance / value.deviation);
  return distance > 0 ? 0 : -std::numeric_limits<double>::infinity();
}

/// Returns the logarithm of the expected improvement: the expectation of max(0, value - best).
inline double log_expected_gain(const Estimate& value, double best) {
  const double distance = value.mean - best;
  if (!(value.deviation > 0)) return std::log(std::max(distance, 0.0));
  const double z = distance / value.deviation, log_density = -0.5 * z * z - kLogSqrt2Pi;
  if (z < kTail) return std::log(value.deviation) + log_density - 2 * std::log(-z) + std::log1p(-3 / (z * z));
  const double below = 0.5 * std::erfc(-z / std::numbers::sqrt2);
  return std::log(value.deviation) + std::log(std::exp(log_density) + z * below);
}

}  // namespace tools::optimise
