#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

using sweep::Choice;

/// An axis of the search space.
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
  double variance = 0;  ///< of its noise, which is independent of other points; 0: exact
};

/// Estimates a function of the axes from some of its values by Kriging: a constant mean and a Matern 5/2 covariance
/// with a length per axis (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, ch. 2, 4, 5). Lengths
/// and roughness maximise the likelihood; hill climbing starts from the previous fit.
class GaussianProcess {
 public:
  explicit GaussianProcess(std::span<const AxisShape> axes);
  ~GaussianProcess();
  GaussianProcess(GaussianProcess&& other) noexcept;

  /// Fits the model to at least one observation and returns the log likelihood per observation. `errors_are_bounds`:
  /// the true errors may be smaller than stated, all by the same factor.
  double fit(std::vector<Observation> observations, bool errors_are_bounds = false);
  Estimate estimate_at(const Choice& point) const;
  /// Adds an estimate as if it had been observed (Kriging believer).
  void add_pseudo_observation(const Choice& point, double value);

 private:
  struct Solution;

  double covariance_of(const Choice& a, const Choice& b) const;
  Solution solve_model(std::span<const Observation> observations);
  /// `variance`: the variance of the process, which the errors are compared with.
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

  /// Fits the model to at least one simulated value, and to approximate looks. `errors`: standard deviations of noisy
  /// simulated values; `errors_are_bounds`: they are assumed upper bounds, not measured.
  using Values = std::map<Choice, double>;
  void fit(const Values& simulated, const Values& looks, const Values& errors = {}, bool errors_are_bounds = false);
  /// Forbids the logarithm, for a metric with a limit of 0 or less.
  void forbid_log() { may_be_log_ = false; }
  /// Returns the estimate on the scale of the model.
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
