#pragma once
#include <map>
#include <span>
#include <vector>

#include "tools/studies/optimise/gaussian_process.h"

namespace tools::optimise {

/// A figure of the points, estimated where it has not been computed. Figures above 0 are estimated by their logarithm
/// if that makes what has been seen likelier. First looks, which are off by a bias and an error, help where there are
/// any.
class Surrogate {
 public:
  explicit Surrogate(std::span<const AxisShape> axes);

  /// Fits the model to values by point: at least one simulated value, and approximate looks. `errors`: standard
  /// deviations of noisy simulated values; `errors_are_bounds`: they are assumed upper bounds, not measured.
  using Values = std::map<Choice, double>;
  void fit(const Values& simulated, const Values& looks, const Values& errors = {}, bool errors_are_bounds = false);
  /// Prevents the logarithm: for a figure whose limit is 0 or less, and so has none.
  void forbid_log() { may_be_log_ = false; }
  /// The figure as it is estimated: inverse() makes it a figure again.
  Estimate at(const Choice& point) const { return process().at(point); }
  double inverse(double value) const;
  double forward(double value) const;
  void believe(const Choice& point, double value) { (is_log_ ? log_ : plain_).believe(point, value); }

 private:
  const GaussianProcess& process() const { return is_log_ ? log_ : plain_; }
  std::vector<Observation> observations(const Values& simulated, const Values& looks, const Values& errors) const;

  GaussianProcess plain_, log_;
  bool may_be_log_ = true, is_log_ = false;
};

}  // namespace tools::optimise
