#include "tools/studies/sweep/results/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/factor.h"
#include "tools/studies/sweep/results/pareto.h"

namespace tools::results {
namespace {

constexpr const char* kUsual[] = {"totals.cycles", "totals.energy_mj.nominal", "totals.power_w.nominal",
                                  "totals.perf.frames_per_joule_gpu"};
constexpr int kMostRounds = 1000;
constexpr double kSettled = 1e-12;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// Effects of levels that add up to the values as closely as may be: each factor in turn takes what the others leave.
/// On a grid the first turn is the last.
class AdditiveModel {
 public:
  AdditiveModel(const std::vector<Factor>& factors, std::vector<double> deviations)
      : factors_(factors), left_(std::move(deviations)), effects_(factors.size()) {
    for (std::size_t f = 0; f < factors.size(); ++f) effects_[f].assign(factors[f].levels.size(), 0);
    const double scale = std::sqrt(squares(left_));
    for (int round = 0; round < kMostRounds; ++round) {
      double change = 0;
      for (std::size_t f = 0; f < factors.size(); ++f) change = std::max(change, fit(f));
      if (change <= kSettled * scale) return;
    }
  }

  const std::vector<double>& effects(std::size_t factor) const { return effects_[factor]; }
  double unexplained() const { return squares(left_); }
  double explained_by(std::size_t factor) const {
    double sum = 0;
    for (const std::size_t level : factors_[factor].at) sum += effects_[factor][level] * effects_[factor][level];
    return sum;
  }

 private:
  double fit(std::size_t f) {
    const Factor& factor = factors_[f];
    std::vector<double> sums(factor.levels.size()), counts(factor.levels.size());
    for (std::size_t i = 0; i < left_.size(); ++i) {
      sums[factor.at[i]] += left_[i];
      ++counts[factor.at[i]];
    }
    double change = 0;
    for (std::size_t level = 0; level < sums.size(); ++level) {
      sums[level] /= counts[level];
      effects_[f][level] += sums[level];
      change = std::max(change, std::abs(sums[level]));
    }
    for (std::size_t i = 0; i < left_.size(); ++i) left_[i] -= sums[factor.at[i]];
    return change;
  }

  const std::vector<Factor>& factors_;
  std::vector<double> left_;
  std::vector<std::vector<double>> effects_;  ///< by factor, then by level
};

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string text_of(const Sensitivity& s) {
  std::string out = fmt::format("{}: mean {} of {} points{}\n\n", s.metric, shown(s.mean), s.points,
                                s.is_grid ? "" : ", which are no full grid: shares are estimates");
  sim::Table table({"axis", "levels", "lowest mean", "at", "highest mean", "at", "range", "share of variance"});
  for (const Effect& e : s.effects) {
    const auto [low, high] = std::ranges::minmax_element(e.means);
    const auto level = [&](auto mean) { return e.levels[static_cast<std::size_t>(mean - e.means.begin())]; };
    table.row({e.axis, fmt::format("{}", e.levels.size()), shown(*low), level(low), shown(*high), level(high),
               percent(e.range), percent(e.share)});
  }
  table.row({"only together", "", "", "", "", "", "", percent(s.rest())});
  return out + table.text();
}

/// Entries of the energy tables that decide the ranking, for each metric that has joules in it.
std::string band_text(const Results& results, const std::vector<std::string>& metrics, const std::vector<bool>& may) {
  EnergyBand band(results, may);
  std::string out;
  for (const std::string& metric : metrics) {
    const Objective objective(results, metric);
    if (!energy_metric(objective.column.name)) continue;
    out += "\n" + band.tornado_text(results, band.metric(objective.column, objective.most));
  }
  if (out.empty()) throw sim::InputError("--energy band: no metric has joules in it; allowed: e.g. energy_mj.nominal");
  return out;
}

}  // namespace

double Sensitivity::rest() const {
  double sum = 0;
  for (const Effect& effect : effects) sum += effect.share;
  return varies ? std::max(0.0, 1 - sum) : 0;
}

Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& may) {
  const Column column = results.column(metric);
  std::vector<std::size_t> rows;
  std::vector<double> values;
  for (std::size_t row = 0; row < may.size(); ++row) {
    const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
    if (!may[row] || !results.rows()[row].is_done() || !number) continue;
    rows.push_back(row);
    values.push_back(number->value);
  }
  if (rows.empty()) {
    const std::string missing = results.what_is_missing();
    throw sim::InputError(
        fmt::format("no point has {} as a number{}", column.name, missing.empty() ? "" : "; " + missing));
  }
  const Factors factors = find_factors(results, rows);
  Sensitivity s{column.name, rows.size(), mean_of(values), false, factors.is_grid, {}};
  for (double& value : values) value -= s.mean;
  const double total = squares(values);
  s.varies = total > 0;
  const AdditiveModel model(factors.list, values);

  std::size_t parameters = 1;
  for (const Factor& factor : factors.list) parameters += factor.levels.size() - 1;
  const bool adjusts = !factors.is_grid && rows.size() > parameters;
  const double noise = adjusts ? model.unexplained() / static_cast<double>(rows.size() - parameters) : 0;
  for (std::size_t f = 0; f < factors.list.size(); ++f) {
    const Factor& factor = factors.list[f];
    Effect effect{factor.name, factor.levels, model.effects(f), 0, 0};
    const auto [low, high] = std::ranges::minmax(effect.means);
    if (s.mean != 0) effect.range = (high - low) / std::abs(s.mean);
    const double by_chance = noise * static_cast<double>(factor.levels.size() - 1);
    if (s.varies) effect.share = std::max(0.0, model.explained_by(f) - by_chance) / total;
    for (double& mean : effect.means) mean += s.mean;
    s.effects.push_back(std::move(effect));
  }
  std::ranges::stable_sort(s.effects, std::greater(), &Effect::share);
  return s;
}

std::string sensitivity_text(const Results& results, std::vector<std::string> metrics,
                             const std::vector<std::string>& where, bool band) {
  if (metrics.empty()) {
    for (const char* path : kUsual) {
      if (results.has_metric(path)) metrics.emplace_back(path);
    }
  }
  const std::vector<bool> may = meeting(results, where);
  std::string out;
  for (const std::string& metric : metrics) {
    if (!out.empty()) out += '\n';
    out += text_of(find_sensitivity(results, metric, may));
  }
  if (band && !metrics.empty()) out += band_text(results, metrics, may);
  const std::string missing = results.what_is_missing();
  if (metrics.empty()) throw sim::InputError(missing.empty() ? "no point has a metric" : missing);
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

}  // namespace tools::results
