#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace tools {

/// Student's t: `share` of its distribution lies below.
double student_t(double degrees, double share = 0.975);
/// Chance that a variable of Student's distribution is larger than `t`.
double student_t_above(double t, double degrees);

/// Mean and standard deviation of draws of a figure.
struct Draws {
  std::size_t count = 0;
  double mean = 0;
  double deviation = 0;  ///< that of a draw, with count - 1 degrees of freedom; 0 for one draw

  /// Half of the 95 % interval around the mean, by Student's t; 0 for one draw.
  double half_width() const;
};
Draws draws_of(std::span<const double> values);

/// Difference of two means whose draws may vary differently (Welch, Biometrika 1947): b - a.
struct MeanDifference {
  double value = 0;
  double error = 0;    ///< its standard deviation
  double degrees = 1;  ///< degrees of freedom, after Welch and Satterthwaite

  /// Half of its 95 % interval.
  double half_width() const { return error == 0 ? 0 : student_t(degrees) * error; }
  /// Chance of a difference so far above zero if there were none: a one-sided test.
  double chance_above() const;
};
MeanDifference difference_of(const Draws& a, const Draws& b);

/// Hypotheses that are rejected, by their chances, if with `error` at most any true one may be (Holm, Scandinavian
/// Journal of Statistics 1979).
std::vector<bool> rejected(std::span<const double> chances, double error);

}  // namespace tools
