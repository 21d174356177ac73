#include "tools/sampling/sample_weights.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "tools/noise/statistics.h"

namespace tools {
namespace {

using Eigen::Index;

Eigen::Map<const Eigen::VectorXd> as_vector(std::span<const double> values) {
  return {values.data(), static_cast<Index>(values.size())};
}

/// Traits per size, standardised over the parts. Traits that are equal in all parts are 0.
struct Traits {
  Eigen::MatrixXd parts;  ///< one row per part
  Eigen::VectorXd whole;
};

Traits standardise_traits(std::span<const SamplePart> parts, const SamplePart& whole) {
  const auto n = static_cast<Index>(parts.size()), p = static_cast<Index>(whole.traits.size());
  Traits traits{Eigen::MatrixXd::Zero(n, p), Eigen::VectorXd::Zero(p)};
  for (std::size_t j = 0; j < whole.traits.size(); ++j) {
    Eigen::VectorXd rates(n);
    for (std::size_t i = 0; i < parts.size(); ++i) {
      rates[static_cast<Index>(i)] = parts[i].traits[j] / parts[i].size;
    }
    const double mean = rates.mean();
    rates.array() -= mean;
    const double spread = std::sqrt(rates.squaredNorm() / static_cast<double>(n));
    if (!(spread > 1e-9 * std::abs(mean))) continue;
    traits.parts.col(static_cast<Index>(j)) = rates / spread;
    traits.whole[static_cast<Index>(j)] = (whole.traits[j] / whole.size - mean) / spread;
  }
  return traits;
}

}  // namespace

SampleWeights::SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge) {
  const auto count = static_cast<double>(parts.size());
  for (const SamplePart& part : parts) sizes_.push_back(part.size);
  const Traits z = standardise_traits(parts, whole);
  Eigen::MatrixXd normal = z.parts.transpose() * z.parts;
  normal.diagonal().array() += count * std::max(ridge, 1e-9);
  const Eigen::MatrixXd solved = normal.llt().solve(z.parts.transpose());
  const Eigen::MatrixXd smoother = (z.parts * solved).array() + 1 / count;
  const Eigen::VectorXd shares = whole.size * ((solved.transpose() * z.whole).array() + 1 / count);
  smoother_.assign(smoother.data(), smoother.data() + smoother.size());
  shares_.assign(shares.begin(), shares.end());
  for (std::size_t i = 0; i < parts.size(); ++i) weights_.push_back(shares_[i] / sizes_[i]);
  degrees_ = std::max(1.0, count - smoother.trace());
}

double SampleWeights::total(std::span<const double> observed) const {
  return as_vector(weights_).dot(as_vector(observed));
}

double SampleWeights::half_width(std::span<const double> observed) const {
  const Eigen::VectorXd rates = as_vector(observed).cwiseQuotient(as_vector(sizes_));
  const Eigen::Map<const Eigen::MatrixXd> smoother(smoother_.data(), rates.size(), rates.size());
  const double left = (rates - smoother * rates).squaredNorm();
  return student_t(degrees_) * std::sqrt(left / degrees_ * as_vector(shares_).squaredNorm());
}

}  // namespace tools
