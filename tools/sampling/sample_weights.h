#pragma once
#include <span>
#include <vector>

namespace tools {

/// A part of a whole that was looked at closely: its size, and what else is known of parts and whole alike.
struct SamplePart {
  double size = 0;
  std::vector<double> traits;
};

/// Estimates totals of a whole from parts that were chosen with chances in proportion to their size.
///
/// Cost of a part per size is a straight line in its traits per size; the line is fitted by ridge regression and
/// read where the whole lies (a calibration estimator: Deville and Särndal, JASA 1992). It is linear in what was
/// observed, so one weight per part serves every quantity, and what adds up in each part adds up in the estimates.
class SampleWeights {
 public:
  /// `ridge` 0: least squares; more: nearer to the mean of all parts.
  SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge);

  const std::vector<double>& weights() const { return weights_; }
  /// The whole's sum of a quantity observed in each part.
  double total(std::span<const double> observed) const;
  /// Half of the 95 % interval around total(), from what the fit leaves.
  double half_width(std::span<const double> observed) const;
  double degrees_of_freedom() const { return degrees_; }

 private:
  std::vector<double> sizes_;
  std::vector<double> smoother_;  ///< a matrix: fitted rates = smoother x observed rates
  std::vector<double> shares_;    ///< weights, of rates instead of sums
  std::vector<double> weights_;
  double degrees_ = 0;
};

}  // namespace tools
