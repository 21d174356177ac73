#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tools/studies/sweep/spec/spec.h"

namespace tools::optimise {

using sweep::Choice;

/// An axis of the space that is searched.
struct AxisShape {
  std::uint32_t values = 1;
  bool ordered = true;  ///< neighbours in the list are alike; otherwise all values are equally far from each other
};

/// Estimate of a value that has not been computed: a normal distribution.
struct Estimate {
  double mean = 0, deviation = 0;
};

/// A value seen at a point.
struct Observation {
  Choice at;
  double value = 0;
  double variance = 0;  ///< the error's: noise that no other point shares; 0: exact
};

/// A function of the axes, estimated from some of its values: Kriging with a constant mean and a Matern 5/2 covariance
/// with a length for each axis. The lengths, and a roughness that no length explains, are those under which what has
/// been seen is likeliest (Rasmussen and
/// Williams, Gaussian Processes for Machine Learning, 2006, ch. 2, 4, 5), found by climbing from where the last fit
/// ended.
class GaussianProcess {
 public:
  explicit GaussianProcess(std::span<const AxisShape> axes);
  ~GaussianProcess();
  GaussianProcess(GaussianProcess&& other) noexcept;

  /// At least one observation. `errors_are_bounds`: errors may be smaller than stated, all by the same factor.
  /// Returns the logarithm of the likelihood, for one of them.
  double fit(std::vector<Observation> observations, bool errors_are_bounds = false);
  Estimate at(const Choice& point) const;
  /// Adds an imagined observation (Kriging believer).
  void believe(const Choice& point, double value);

 private:
  struct Solution;

  double covariance(const Choice& a, const Choice& b) const;
  Solution solve(std::span<const Observation> observations);
  /// `variance`: the process's, beside which the errors' count.
  Solution solve(std::span<const Observation> observations, double variance);

  std::vector<AxisShape> axes_;
  std::vector<int> lengths_;  ///< one for each axis, as powers of a step
  int roughness_ = 0;         ///< which of some
  int error_share_ = 0;       ///< which of some: the part of stated errors that the values show
  std::vector<Observation> seen_;
  double shift_ = 0, scale_ = 1;  ///< the model knows (value - shift) / scale
  std::vector<double> inverse_lengths_;
  std::unique_ptr<Solution> solution_;
};

}  // namespace tools::optimise
