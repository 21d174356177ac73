#include "tools/studies/optimise/surrogate.h"

#include <algorithm>
#include <cmath>

namespace tools::optimise {
namespace {

constexpr double kLookDeviation =
    0.1;  // deviation of a look's error, in those of the values, as long as nothing is known

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

double Surrogate::forward(double value) const { return is_log_ ? std::log(value) : value; }
double Surrogate::inverse(double value) const { return is_log_ ? std::exp(value) : value; }

std::vector<Observation> Surrogate::observations(const Values& simulated, const Values& looks,
                                                 const Values& of_noise) const {
  std::vector<Observation> all;
  std::vector<double> values, errors;
  for (const auto& [point, value] : simulated) {
    const auto noise = of_noise.find(point);
    const double error = noise == of_noise.end() ? 0 : noise->second / (is_log_ ? value : 1);
    all.push_back({point, forward(value), error * error});
    values.push_back(forward(value));
    if (const auto look = looks.find(point); look != looks.end()) {
      errors.push_back(forward(look->second) - forward(value));
    }
  }
  const double unknown = kLookDeviation * kLookDeviation * variance_of(values);
  const auto pairs = static_cast<double>(errors.size());
  const double bias = mean_of(errors);
  const double variance = (variance_of(errors) * pairs + unknown) / (pairs + 1);
  for (const auto& [point, value] : looks) {
    if (!simulated.contains(point)) all.push_back({point, forward(value) - bias, variance});
  }
  return all;
}

void Surrogate::fit(const Values& simulated, const Values& looks, const Values& errors, bool errors_are_bounds) {
  is_log_ = false;
  const double plain = plain_.fit(observations(simulated, looks, errors), errors_are_bounds);
  const auto is_positive = [](const Values::value_type& v) { return v.second > 0; };
  if (!may_be_log_ || !std::ranges::all_of(simulated, is_positive) || !std::ranges::all_of(looks, is_positive)) return;
  is_log_ = true;
  const std::vector<Observation> logs = observations(simulated, looks, errors);
  double jacobian = 0;
  for (const Observation& o : logs)
    jacobian += o.value;  // Jacobian of the logarithm: a value's density is over the value
  jacobian /= static_cast<double>(logs.size());
  is_log_ = log_.fit(logs, errors_are_bounds) - jacobian > plain;
}

}  // namespace tools::optimise
