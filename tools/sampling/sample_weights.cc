#include "tools/sampling/sample_weights.h"

#include <algorithm>
#include <cmath>

namespace tools {
namespace {

using Matrix = std::vector<std::vector<double>>;

/// Solves a x = b for a symmetric positive definite `a`, which is used up; each row of b is a right-hand side.
void solve(Matrix& a, Matrix& b) {
  const std::size_t n = a.size();
  for (std::size_t j = 0; j < n; ++j) {  // Cholesky
    for (std::size_t k = 0; k < j; ++k) a[j][j] -= a[j][k] * a[j][k];
    a[j][j] = std::sqrt(a[j][j]);
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
    }
  }
  for (std::vector<double>& x : b) {
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
      x[i] /= a[i][i];
    }
    for (std::size_t i = n; i-- > 0;) {
      for (std::size_t k = i + 1; k < n; ++k) x[i] -= a[k][i] * x[k];
      x[i] /= a[i][i];
    }
  }
}

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

SampleWeights::SampleWeights(std::span<const SamplePart> parts, const SamplePart& whole, double ridge)
    : whole_(whole.size) {
  const std::size_t n = parts.size(), p = whole.traits.size();
  const auto count = static_cast<double>(n);
  for (const SamplePart& part : parts) sizes_.push_back(part.size);

  // Traits per size, standardised over the parts: those in which parts do not differ say nothing.
  Matrix z(n, std::vector<double>(p));
  std::vector<double> at(p);
  for (std::size_t j = 0; j < p; ++j) {
    double mean = 0, square = 0;
    for (std::size_t i = 0; i < n; ++i) mean += parts[i].traits[j] / parts[i].size / count;
    for (std::size_t i = 0; i < n; ++i) square += std::pow(parts[i].traits[j] / parts[i].size - mean, 2) / count;
    const double spread = std::sqrt(square);
    if (!(spread > 1e-9 * std::abs(mean))) continue;
    for (std::size_t i = 0; i < n; ++i) z[i][j] = (parts[i].traits[j] / parts[i].size - mean) / spread;
    at[j] = (whole.traits[j] / whole.size - mean) / spread;
  }

  Matrix normal(p, std::vector<double>(p));
  for (std::size_t a = 0; a < p; ++a) {
    for (std::size_t b = 0; b < p; ++b) {
      for (std::size_t i = 0; i < n; ++i) normal[a][b] += z[i][a] * z[i][b];
    }
    normal[a][a] += count * std::max(ridge, 1e-9);
  }
  Matrix solved = z;
  solve(normal, solved);

  smoother_.assign(n, std::vector<double>(n));
  double trace = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) smoother_[i][k] = 1 / count + dot(z[i], solved[k]);
    trace += smoother_[i][i];
    weights_.push_back(whole_ * (1 / count + dot(at, solved[i])) / sizes_[i]);
  }
  degrees_ = std::max(1.0, count - trace);
}

double SampleWeights::total(std::span<const double> observed) const { return dot(weights_, observed); }

double SampleWeights::half_width(std::span<const double> observed) const {
  std::vector<double> rates;
  for (std::size_t i = 0; i < sizes_.size(); ++i) rates.push_back(observed[i] / sizes_[i]);
  double left = 0, spread = 0;
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    left += std::pow(rates[i] - dot(smoother_[i], rates), 2);
    spread += std::pow(weights_[i] * sizes_[i], 2);
  }
  return student_t(degrees_) * std::sqrt(left / degrees_ * spread);
}

double student_t(double degrees) {
  constexpr double kZ = 1.959964;
  constexpr double z3 = kZ * kZ * kZ, z5 = z3 * kZ * kZ, z7 = z5 * kZ * kZ;
  // Expansion in 1 / degrees: Abramowitz and Stegun 26.7.5.
  const double d = std::max(1.0, degrees);
  return kZ + (z3 + kZ) / (4 * d) + (5 * z5 + 16 * z3 + 3 * kZ) / (96 * d * d) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * kZ) / (384 * d * d * d);
}

}  // namespace tools
