#include "tools/studies/optimise/table_draws.h"

#include <algorithm>
#include <cmath>

#include "sim/hash.h"
#include "tools/pricing/energy_study.h"
#include "tools/studies/optimise/surrogate.h"

namespace tools::optimise {
namespace {

constexpr const char* kArea = "totals.area_mm2";
constexpr std::uint64_t kAreaSeed = 0x61726561;  // differs from the seeds of energy entries

/// Returns the probability that a normal variable is at most `limit`.
double normal_at_most(double limit, double mean, double error) {
  return std::exp(log_probability({mean, error}, limit, false));
}

}  // namespace

sim::Band band_at(const ReportFile& report, const std::string& path) {
  return {report.number(path + ".low"), report.number(path + ".nominal"), report.number(path + ".high")};
}

double area_at(const sim::Band& band, double quantile) { return value_at_quantile(band, quantile); }

MeasuredMetric MetricUncertainty::at(std::size_t draw) const {
  MeasuredMetric scaled = seen;
  scaled.value *= factor(draw);
  if (scaled.draws) {
    scaled.draws->mean *= factor(draw);
    scaled.draws->deviation *= factor(draw);
  }
  return scaled;
}

double MetricUncertainty::quantile(double share) const {
  const double error = seen.standard_error();
  if (factors.empty() && error == 0) return seen.value;
  const auto share_below = [&](double value) {
    if (factors.empty()) return normal_at_most(value, seen.value, error);
    double sum = 0;
    for (const double f : factors) sum += normal_at_most(value, seen.value * f, error * f);
    return sum / static_cast<double>(factors.size());
  };
  const auto [least, most] = factors.empty() ? std::ranges::minmax_result<double>{1, 1} : std::ranges::minmax(factors);
  constexpr double kWide = 8;  // standard deviations
  double low = std::min(seen.value * least, seen.value * most) - kWide * error * most;
  double high = std::max(seen.value * least, seen.value * most) + kWide * error * most;
  for (int step = 0; step < 60 && low < high; ++step) {
    const double middle = (low + high) / 2;
    (share_below(middle) < share ? low : high) = middle;
  }
  return high;
}

double probability_met(const Goal& goal, const MeasuredMetric& seen) {
  const double error = seen.standard_error();
  if (error == 0) return goal.is_met(seen.value) ? 1 : 0;
  return std::exp(log_probability({seen.value, error}, goal.limit, !goal.is_upper_limit()));
}

MetricUncertainty TableDraws::uncertainty_of(const std::string& path, const MeasuredMetric& seen) {
  MetricUncertainty spread{seen, {}};
  const auto energy = energy_metric(path);
  if (!energy && path != kArea) return spread;
  auto [entry, is_new] = factors_.try_emplace(energy ? energy->block : kArea);
  std::vector<double>& factors = entry->second;
  if (is_new && energy) {
    if (!priced_) priced_ = std::make_unique<PricedRun>(report_);
    const double nominal = nominal_energy_pj(*priced_, energy->block);
    factors = energy_by_draw_pj(*priced_, energy->block, kTableDraws);
    for (double& pj : factors) pj /= nominal;
  } else if (is_new) {
    const sim::Band band = band_at(report_, "totals.area_band_mm2");
    for (std::uint64_t draw = 0; draw < kTableDraws; ++draw) {
      factors.push_back(area_at(band, sim::hash_to_unit_float(sim::hash(kAreaSeed, draw))) / band.nominal);
    }
  }
  spread.factors = factors;
  if (energy && energy->inverse) {
    for (double& factor : spread.factors) factor = 1 / factor;
  }
  return spread;
}

}  // namespace tools::optimise
