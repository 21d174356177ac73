#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace tools {

/// Returns the quantile of Student's t distribution: `share` of it is below.
double student_t(double degrees, double share = 0.975);
/// Returns the probability that a variable of Student's t distribution exceeds `t`.
double student_t_above(double t, double degrees);

/// Mean and standard deviation of draws of a figure.
struct Draws {
  std::size_t count = 0;
  double mean = 0;
  double deviation = 0;  ///< of one draw, with count - 1 degrees of freedom; 0 for a single draw

  /// Returns half of the 95 % interval of the mean, by Student's t; 0 for a single draw.
  double half_width() const;
};
Draws draws_of(std::span<const double> values);

/// Difference b - a of two means with possibly unequal variances (Welch, Biometrika 1947).
struct MeanDifference {
  double value = 0;
  double error = 0;    ///< standard deviation of `value`
  double degrees = 1;  ///< degrees of freedom, after Welch and Satterthwaite

  /// Returns half of its 95 % interval.
  double half_width() const { return error == 0 ? 0 : student_t(degrees) * error; }
  /// Returns the one-sided p-value: the probability of such a difference or a larger one if the true one is zero.
  double chance_above() const;
};
MeanDifference difference_of(const Draws& a, const Draws& b);

/// Returns which hypotheses are rejected, given their p-values, at a family-wise error rate of `error` (Holm,
/// Scandinavian Journal of Statistics 1979).
std::vector<bool> reject_hypotheses(std::span<const double> chances, double error);

}  // namespace tools
