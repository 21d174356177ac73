#include "tools/studies/optimise/surrogate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace tools::optimise {
namespace {

using Eigen::Index;

constexpr std::size_t kMostFitted = 150;  // observations used to find the lengths; the time grows with their cube
constexpr int kMostClimbs = 6;
constexpr std::array<int, 4> kStrides = {1, -1, 3, -3};  // steps of hill climbing; the long ones can leave local maxima
constexpr int kShortest = -4, kLongest = 6;              // lengths as powers of kStep; 1 is the whole axis
constexpr double kStep = 1.7;
constexpr std::array<double, 4> kNuggets = {1e-6, 1e-4, 1e-2, 1e-1};  // roughness, as a share of the variance
constexpr std::array<double, 4> kErrorShares = {1, 0.5, 0.25,
                                                0.125};  // shares of the stated standard deviations of the errors
constexpr double kPriorOfShare = 0.5;                    // log prior ratio of an error share to the next smaller one
constexpr double kPriorDeviation = 3;                    // prior standard deviation of a length, in steps
constexpr int kRounds = 4;                               // iterations in which errors and variance converge
constexpr double kPriorOfRoughness = 1;                  // log prior ratio of a roughness to the next larger one

Index eigen_index(std::size_t i) { return static_cast<Index>(i); }

double matern_5_2(double distance2) {
  const double d = std::sqrt(5 * distance2);
  return (1 + d + d * d / 3) * std::exp(-d);
}

std::vector<double> inverse_lengths_of(std::span<const int> lengths) {
  std::vector<double> all;
  for (const int length : lengths) all.push_back(std::pow(kStep, -length));
  return all;
}

/// Returns at most kMostFitted observations, evenly spaced over the list.
std::vector<Observation> thin_out(std::span<const Observation> all) {
  if (all.size() <= kMostFitted) return {all.begin(), all.end()};
  std::vector<Observation> some;
  for (std::size_t i = 0; i < kMostFitted; ++i) some.push_back(all[i * all.size() / kMostFitted]);
  return some;
}

}  // namespace

/// The solution of a Gaussian process's linear equations.
struct GaussianProcess::Solution {
  double likelihood = 0;  ///< log likelihood, including the priors
  double nugget = 0, mean = 0, variance = 0;
  Eigen::MatrixXd factor;  ///< lower Cholesky factor of the covariance matrix
  Eigen::VectorXd values, weights;
};

GaussianProcess::GaussianProcess(std::span<const AxisShape> axes)
    : axes_(axes.begin(), axes.end()), lengths_(axes.size(), 0) {}
GaussianProcess::~GaussianProcess() = default;
GaussianProcess::GaussianProcess(GaussianProcess&& other) noexcept = default;

double GaussianProcess::covariance_of(const Choice& a, const Choice& b) const {
  double distance2 = 0;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (a[k] == b[k]) continue;
    const double apart = axes_[k].ordered ? (static_cast<double>(a[k]) - b[k]) / (axes_[k].values - 1) : 1;
    distance2 += apart * apart * inverse_lengths_[k] * inverse_lengths_[k];
  }
  return matern_5_2(distance2);
}

/// Solves the model's equations with the current parameters. The errors are absolute, but the equations need them
/// relative to the variance of the process, which the solution gives. Therefore it iterates a few times.
GaussianProcess::Solution GaussianProcess::solve_model(std::span<const Observation> observations) {
  Solution s = solve_model(observations, 1);
  const bool has_noise = std::ranges::any_of(observations, [](const Observation& o) { return o.variance > 0; });
  for (int round = 1; has_noise && round < kRounds; ++round) s = solve_model(observations, s.variance);
  return s;
}

GaussianProcess::Solution GaussianProcess::solve_model(std::span<const Observation> observations, double variance) {
  inverse_lengths_ = inverse_lengths_of(lengths_);
  const Index n = eigen_index(observations.size());
  Solution s;
  const double share = kErrorShares.at(static_cast<std::size_t>(error_share_));
  s.nugget = kNuggets.at(static_cast<std::size_t>(roughness_));
  s.values.resize(n);
  s.factor.resize(n, n);
  for (Index i = 0; i < n; ++i) {
    const Observation& here = observations[static_cast<std::size_t>(i)];
    s.values[i] = (here.value - shift_) / scale_;
    for (Index j = 0; j < i; ++j) {
      s.factor(i, j) = covariance_of(here.at, observations[static_cast<std::size_t>(j)].at);
    }
    s.factor(i, i) = 1 + s.nugget + here.variance * share * share / (scale_ * scale_ * variance);
  }
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factored(s.factor);  // factorises in place
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

double GaussianProcess::fit(std::vector<Observation> observations, bool errors_are_upper_bounds) {
  observations_ = std::move(observations);
  const auto count = static_cast<double>(observations_.size());
  shift_ = 0;
  for (const Observation& o : observations_) shift_ += o.value / count;
  double sum2 = 0;
  for (const Observation& o : observations_) sum2 += (o.value - shift_) * (o.value - shift_) / count;
  scale_ = sum2 > 0 ? std::sqrt(sum2) : 1;

  const std::vector<Observation> fitted = thin_out(observations_);
  double best = solve_model(fitted).likelihood;
  const auto attempt = [&](int& parameter, int value, int least, int most) {
    if (value < least || value > most) return false;
    const int before = std::exchange(parameter, value);
    const double likelihood = solve_model(fitted).likelihood;
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
  bool improved = true;
  for (int climbs = 0; climbs < kMostClimbs && improved; ++climbs) {
    improved = false;
    for (int& length : lengths_) improved |= climb(length, kShortest, kLongest);
    improved |= climb(roughness_, 0, static_cast<int>(kNuggets.size()) - 1);
    if (errors_are_upper_bounds) improved |= climb(error_share_, 0, static_cast<int>(kErrorShares.size()) - 1);
  }
  solution_ = std::make_unique<Solution>(solve_model(observations_));
  return best / static_cast<double>(fitted.size()) - std::log(scale_);
}

Estimate GaussianProcess::estimate_at(const Choice& point) const {
  const Solution& s = *solution_;
  Eigen::VectorXd near(s.values.size());
  for (std::size_t i = 0; i < observations_.size(); ++i)
    near[eigen_index(i)] = covariance_of(point, observations_[i].at);
  const double mean = s.mean + near.dot(s.weights);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(near);
  const double variance = s.variance * std::max(1 + s.nugget - near.squaredNorm(), 0.0);
  return {shift_ + scale_ * mean, scale_ * std::sqrt(variance)};
}

void GaussianProcess::add_pseudo_observation(const Choice& point, double value) {
  Solution& s = *solution_;
  const Index n = s.values.size();
  Eigen::VectorXd row(n);
  for (std::size_t i = 0; i < observations_.size(); ++i)
    row[eigen_index(i)] = covariance_of(point, observations_[i].at);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(row);
  s.factor.conservativeResize(n + 1, n + 1);
  s.factor.row(n).head(n) = row.transpose();
  s.factor(n, n) = std::sqrt(std::max(1 + s.nugget - row.squaredNorm(), s.nugget));
  s.values.conservativeResize(n + 1);
  s.values[n] = (value - shift_) / scale_;
  observations_.push_back({point, value, 0});
  s.weights = s.values - s.mean * Eigen::VectorXd::Ones(n + 1);
  s.factor.triangularView<Eigen::Lower>().solveInPlace(s.weights);
  s.factor.triangularView<Eigen::Lower>().adjoint().solveInPlace(s.weights);
}

namespace {

/// Prior standard deviation of the error of a first look (approximate simulation), relative to that of the values.
constexpr double kLookDeviation = 0.1;

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

double variance_of(std::span<const double> values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return values.size() < 2 ? 0 : sum / static_cast<double>(values.size() - 1);
}

}  // namespace

Surrogate::Surrogate(std::span<const AxisShape> axes) : plain_(axes), log_(axes) {}

double Surrogate::to_model_scale(double value) const { return is_log_ ? std::log(value) : value; }
double Surrogate::from_model_scale(double value) const { return is_log_ ? std::exp(value) : value; }

std::vector<Observation> Surrogate::make_observations(const Values& simulated, const Values& looks,
                                                      const Values& of_noise) const {
  std::vector<Observation> all;
  std::vector<double> values, errors;
  for (const auto& [point, value] : simulated) {
    const auto noise = of_noise.find(point);
    const double error = noise == of_noise.end() ? 0 : noise->second / (is_log_ ? value : 1);
    all.push_back({point, to_model_scale(value), error * error});
    values.push_back(to_model_scale(value));
    if (const auto look = looks.find(point); look != looks.end()) {
      errors.push_back(to_model_scale(look->second) - to_model_scale(value));
    }
  }
  const double unknown = kLookDeviation * kLookDeviation * variance_of(values);
  const auto pairs = static_cast<double>(errors.size());
  const double bias = mean_of(errors);
  const double variance = (variance_of(errors) * pairs + unknown) / (pairs + 1);
  for (const auto& [point, value] : looks) {
    if (!simulated.contains(point)) all.push_back({point, to_model_scale(value) - bias, variance});
  }
  return all;
}

void Surrogate::fit(const Values& simulated, const Values& looks, const Values& errors, bool errors_are_upper_bounds) {
  is_log_ = false;
  const double plain = plain_.fit(make_observations(simulated, looks, errors), errors_are_upper_bounds);
  const auto is_positive = [](const Values::value_type& v) { return v.second > 0; };
  if (!may_be_log_ || !std::ranges::all_of(simulated, is_positive) || !std::ranges::all_of(looks, is_positive)) return;
  is_log_ = true;
  const std::vector<Observation> logs = make_observations(simulated, looks, errors);
  double jacobian = 0;
  for (const Observation& o : logs) jacobian += o.value;  // likelihoods refer to values, not to their logarithms
  jacobian /= static_cast<double>(logs.size());
  is_log_ = log_.fit(logs, errors_are_upper_bounds) - jacobian > plain;
}

}  // namespace tools::optimise
