#include "tools/studies/optimise/gaussian_process.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace tools::optimise {
namespace {

using Eigen::Index;

constexpr std::size_t kMostFitted = 150;  // observations from which lengths are found: the time grows as their cube
constexpr int kMostClimbs = 6;
constexpr std::array<int, 4> kStrides = {1, -1, 3, -3};  // long ones lead out of what is highest only nearby
constexpr int kShortest = -4, kLongest = 6;  // lengths: powers of kStep; at 1 an axis changes much from end to end
constexpr double kStep = 1.7;
constexpr std::array<double, 4> kNuggets = {1e-6, 1e-4, 1e-2, 1e-1};   // roughness, of the variance
constexpr std::array<double, 4> kErrorShares = {1, 0.5, 0.25, 0.125};  // of the errors' deviations
constexpr double kPriorOfShare = 0.5;    // how much likelier, as a logarithm, is the next larger one
constexpr double kPriorDeviation = 3;    // deviation of a length, in steps, about 1
constexpr int kRounds = 4;               // rounds until errors have their weight
constexpr double kPriorOfRoughness = 1;  // how much likelier, as a logarithm, is the next lower one

Index index(std::size_t i) { return static_cast<Index>(i); }

double matern(double distance2) {
  const double d = std::sqrt(5 * distance2);
  return (1 + d + d * d / 3) * std::exp(-d);
}

std::vector<double> inverses(std::span<const int> lengths) {
  std::vector<double> all;
  for (const int length : lengths) all.push_back(std::pow(kStep, -length));
  return all;
}

/// Some of them, evenly over their order.
std::vector<Observation> thinned(std::span<const Observation> all) {
  if (all.size() <= kMostFitted) return {all.begin(), all.end()};
  std::vector<Observation> some;
  for (std::size_t i = 0; i < kMostFitted; ++i) some.push_back(all[i * all.size() / kMostFitted]);
  return some;
}

}  // namespace

/// Solution of the linear equations that the model is.
struct GaussianProcess::Solution {
  double likelihood = 0;  ///< its logarithm, with that of the lengths
  double nugget = 0, mean = 0, variance = 0;
  Eigen::MatrixXd factor;  ///< lower triangle of the covariances' Cholesky factorisation
  Eigen::VectorXd values, weights;
};

GaussianProcess::GaussianProcess(std::span<const AxisShape> axes)
    : axes_(axes.begin(), axes.end()), lengths_(axes.size(), 0) {}
GaussianProcess::~GaussianProcess() = default;
GaussianProcess::GaussianProcess(GaussianProcess&& other) noexcept = default;

double GaussianProcess::covariance(const Choice& a, const Choice& b) const {
  double distance2 = 0;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (a[k] == b[k]) continue;
    const double apart = axes_[k].ordered ? (static_cast<double>(a[k]) - b[k]) / (axes_[k].values - 1) : 1;
    distance2 += apart * apart * inverse_lengths_[k] * inverse_lengths_[k];
  }
  return matern(distance2);
}

/// With the present parameters. Errors are known by themselves, and the process's variance follows from the solution:
/// what they are worth beside it is found in a few rounds.
GaussianProcess::Solution GaussianProcess::solve(std::span<const Observation> observations) {
  Solution s = solve(observations, 1);
  const bool has_errors = std::ranges::any_of(observations, [](const Observation& o) { return o.variance > 0; });
  for (int round = 1; has_errors && round < kRounds; ++round) s = solve(observations, s.variance);
  return s;
}

GaussianProcess::Solution GaussianProcess::solve(std::span<const Observation> observations, double variance) {
  inverse_lengths_ = inverses(lengths_);
  const Index n = index(observations.size());
  Solution s;
  const double share = kErrorShares.at(static_cast<std::size_t>(error_share_));
  s.nugget = kNuggets.at(static_cast<std::size_t>(roughness_));
  s.values.resize(n);
  s.factor.resize(n, n);
  for (Index i = 0; i < n; ++i) {
    const Observation& here = observations[static_cast<std::size_t>(i)];
    s.values[i] = (here.value - shift_) / scale_;
    for (Index j = 0; j < i; ++j) {
      s.factor(i, j) = covariance(here.at, observations[static_cast<std::size_t>(j)].at);
    }
    s.factor(i, i) = 1 + s.nugget + here.variance * share * share / (scale_ * scale_ * variance);
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factored(s.factor);  // in place
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
  const Eigen::VectorXd solved_ones = factored.solve(ones);
  s.mean = solved_ones.dot(s.values) / ones.dot(solved_ones);
  const Eigen::VectorXd errors = s.values - s.mean * ones;
  s.weights = factored.solve(errors);
  const auto count = static_cast<double>(n);
  s.variance = std::max(errors.dot(s.weights) / count, 1e-9);
  s.likelihood = -0.5 * count * std::log(s.variance) - s.factor.diagonal().array().log().sum();
  for (const int length : lengths_) s.likelihood -= 0.5 * (length / kPriorDeviation) * (length / kPriorDeviation);
  s.likelihood -= kPriorOfRoughness * roughness_;
  s.likelihood -= kPriorOfShare * error_share_;
  if (factored.info() != Eigen::Success || !std::isfinite(s.likelihood)) s.likelihood = -1e300;
  return s;
}

double GaussianProcess::fit(std::vector<Observation> observations, bool errors_are_bounds) {
  seen_ = std::move(observations);
  const auto count = static_cast<double>(seen_.size());
  shift_ = 0;
  for (const Observation& o : seen_) shift_ += o.value / count;
  double sum2 = 0;
  for (const Observation& o : seen_) sum2 += (o.value - shift_) * (o.value - shift_) / count;
  scale_ = sum2 > 0 ? std::sqrt(sum2) : 1;

  const std::vector<Observation> fitted = thinned(seen_);
  double best = solve(fitted).likelihood;
  const auto attempt = [&](int& parameter, int value, int least, int most) {
    if (value < least || value > most) return false;
    const int before = std::exchange(parameter, value);
    const double likelihood = solve(fitted).likelihood;
    if (likelihood > best + 1e-6) {
      best = likelihood;
      return true;
    }
    parameter = before;
    return false;
  };
  const auto climb = [&](int& parameter, int least, int most) {
    return std::ranges::any_of(kStrides,
                               [&](int stride) { return attempt(parameter, parameter + stride, least, most); });
  };
  bool higher = true;
  for (int climbs = 0; climbs < kMostClimbs && higher; ++climbs) {
    higher = false;
    for (int& length : lengths_) higher |= climb(length, kShortest, kLongest);
    higher |= climb(roughness_, 0, static_cast<int>(kNuggets.size()) - 1);
    if (errors_are_bounds) higher |= climb(error_share_, 0, static_cast<int>(kErrorShares.size()) - 1);
  }
  solution_ = std::make_unique<Solution>(solve(seen_));
  return best / static_cast<double>(fitted.size()) - std::log(scale_);
}

Estimate GaussianProcess::at(const Choice& point) const {
  const Solution& s = *solution_;
  Eigen::VectorXd near(s.values.size());
  for (std::size_t i = 0; i < seen_.size(); ++i) near[index(i)] = covariance(point, seen_[i].at);
  const double mean = s.mean + near.dot(s.weights);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(near);
  const double variance = s.variance * std::max(1 + s.nugget - near.squaredNorm(), 0.0);
  return {shift_ + scale_ * mean, scale_ * std::sqrt(variance)};
}

void GaussianProcess::believe(const Choice& point, double value) {
  Solution& s = *solution_;
  const Index n = s.values.size();
  Eigen::VectorXd row(n);
  for (std::size_t i = 0; i < seen_.size(); ++i) row[index(i)] = covariance(point, seen_[i].at);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(row);
  s.factor.conservativeResize(n + 1, n + 1);
  s.factor.row(n).head(n) = row.transpose();
  s.factor(n, n) = std::sqrt(std::max(1 + s.nugget - row.squaredNorm(), s.nugget));
  s.values.conservativeResize(n + 1);
  s.values[n] = (value - shift_) / scale_;
  seen_.push_back({point, value, 0});
  s.weights = s.values - s.mean * Eigen::VectorXd::Ones(n + 1);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(s.weights);
  s.factor.triangularView<Eigen::Lower>().adjoint().solveInPlace(s.weights);
}

}  // namespace tools::optimise
