#pragma once
#include <span>
#include <vector>

namespace tools {

/// A measured part of a whole: its size, and traits known for parts and whole.
struct SamplePart {
  double size = 0;
  std::vector<double> traits;
};

/// Estimates totals of a whole from parts drawn with probability proportional to size.
///
/// 1. The rate (quantity per size) is modelled as linear in the traits per size, fitted by ridge regression and
/// evaluated at the whole's traits: a calibration estimator (Deville and Särndal, JASA 1992).
/// 2. It is linear in the observations, so one weight per part serves every quantity, and sums of quantities stay
/// consistent.
class SampleWeights {
 public:
  /// `ridge`: 0 gives least squares; larger values give estimates nearer to the mean of the parts.
  SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge);

  const std::vector<double>& part_weights() const { return weights_; }
  /// Estimates the whole's total of a quantity observed in each part.
  double total(std::span<const double> observed) const;
  /// Half-width of the 95 % interval of total(), from the residuals of the fit.
  double half_width(std::span<const double> observed) const;
  double degrees_of_freedom() const { return degrees_; }

 private:
  std::vector<double> sizes_;
  std::vector<double> smoother_;  ///< matrix: fitted rates = smoother x observed rates
  std::vector<double> shares_;    ///< weights of rates instead of sums
  std::vector<double> weights_;
  double degrees_ = 0;
};

}  // namespace tools
