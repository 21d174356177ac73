#include "tools/studies/sweep/results/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/report/table.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/factor.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/notes.h"
#include "tools/studies/sweep/results/pareto.h"

namespace tools::results {
namespace {

constexpr const char* kUsualFigures[] = {"totals.cycles", "totals.energy_mj.nominal", "totals.power_w.nominal",
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
  AdditiveModel(const std::vector<Factor>& factors, const std::vector<double>& deviations)
      : factors_(factors), deviations_(deviations), left_(deviations), effects_(factors.size()) {
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
  /// Sum of the products of effect and value: all factors together come to what the model explains, though factors that
  /// are no grid go together (Li et al., J. Phys. Chem. A 114, 2010: structural and correlative sensitivity). On a
  /// grid, the sum of the effect's squares.
  double explained_by(std::size_t factor) const {
    double sum = 0;
    const std::vector<std::size_t>& at = factors_[factor].at;
    for (std::size_t i = 0; i < at.size(); ++i) sum += effects_[factor][at[i]] * deviations_[i];
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
  const std::vector<double>& deviations_;
  std::vector<double> left_;
  std::vector<std::vector<double>> effects_;  ///< by factor, then by level
};

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string text_of(const Sensitivity& s) {
  std::string out = fmt::format("{}: mean {} of {} points{}\n", metric_name(s.metric), shown(s.mean), s.points,
                                s.is_grid ? "" : fmt::format(", which are {}", kNoGrid));
  const bool noisy = !s.noise_text.empty();
  if (noisy) out += s.noise_text + "\n";
  std::vector<std::string> header = {"axis",         "levels", "lowest mean", "at",
                                     "highest mean", "at",     "range",       "share of variance"};
  if (noisy) header.emplace_back("95 %");
  sim::Table table(header);
  for (const Effect& e : s.effects) {
    const auto [low, high] = std::ranges::minmax_element(e.means);
    const auto level = [&](auto mean) { return e.levels[static_cast<std::size_t>(mean - e.means.begin())]; };
    std::vector<std::string> cells = {e.axis,           fmt::format("{}", e.levels.size()),
                                      shown(*low),      level(low),
                                      shown(*high),     level(high),
                                      percent(e.range), percent(e.share)};
    if (noisy) cells.push_back(e.interval_text());
    table.add_row(std::move(cells));
  }
  const auto part = [&](const char* name, double share) {
    std::vector<std::string> cells = {name, "", "", "", "", "", "", percent(share)};
    cells.resize(header.size());
    table.add_row(std::move(cells));
  };
  part("only together", s.rest());
  if (noisy) part("noise", s.noise);
  return out + "\n" + table.text();
}

/// Rows that may be and have a number. InputError if there are none.
std::vector<std::size_t> numbers_in(const Results& results, const Column& column, const std::vector<bool>& may) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < may.size(); ++row) {
    if (may[row] && results.rows()[row].is_done() && amount_of(column.values[row])) rows.push_back(row);
  }
  if (!rows.empty()) return rows;
  const std::string missing = results.what_is_missing();
  throw sim::InputError(
      fmt::format("no point has {} as a number{}", shown_name(column), missing.empty() ? "" : "; " + missing));
}

/// Shares of the variance of some values about 0.
struct Shares {
  std::vector<double> axes;  ///< by factor
  double noise = 0;
};

/// `variance`: that of a value by noise. On a grid it is taken off each axis as often as the axis has degrees of
/// freedom; elsewhere what the model does not explain is, of which noise is a part.
Shares shares_of(const Factors& factors, const std::vector<double>& values, double variance) {
  const double total = squares(values);
  Shares out{std::vector<double>(factors.list.size()), 0};
  if (total == 0) return out;
  const AdditiveModel model(factors.list, values);
  std::size_t parameters = 1;
  for (const Factor& factor : factors.list) parameters += factor.levels.size() - 1;
  const bool adjusts = !factors.is_grid && values.size() > parameters;
  const double by_chance = adjusts ? model.unexplained() / static_cast<double>(values.size() - parameters) : 0;
  for (std::size_t f = 0; f < factors.list.size(); ++f) {
    const double taken = std::max(by_chance, variance) * static_cast<double>(factors.list[f].levels.size() - 1);
    out.axes[f] = std::max(0.0, model.explained_by(f) - taken) / total;
  }
  out.noise = variance * static_cast<double>(values.size() - 1) / total;
  return out;
}

/// A draw of the normal distribution with mean 0 and deviation 1 (Box and Muller, 1958).
double normal_draw(std::uint64_t draw, std::uint64_t point) {
  const auto uniform = [&](std::uint64_t which) {
    return (static_cast<double>(sim::hash(draw, point, which) >> 11) + 0.5) * 0x1p-53;
  };
  return std::sqrt(-2 * std::log(uniform(0))) * std::cos(2 * std::numbers::pi * uniform(1));
}

/// Intervals of shares: those of sweeps whose values are drawn about the present ones, which have noise already.
void find_intervals(const Factors& factors, const std::vector<double>& values, const std::vector<double>& variances,
                    std::vector<Effect>& effects) {
  constexpr std::uint64_t kSweeps = 400;
  std::vector<std::vector<double>> shares(effects.size());
  for (std::uint64_t draw = 0; draw < kSweeps; ++draw) {
    std::vector<double> drawn = values;
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i] += std::sqrt(variances[i]) * normal_draw(draw, i);
    const double mean = mean_of(drawn);
    for (double& value : drawn) value -= mean;
    const Shares of_draw = shares_of(factors, drawn, 2 * mean_of(variances));
    // The variance of the drawn values has the noise twice, that of the sweep once.
    const double scale = 1 / (1 - std::min(0.9, of_draw.noise / 2));
    for (std::size_t f = 0; f < effects.size(); ++f) shares[f].push_back(std::min(1.0, scale * of_draw.axes[f]));
  }
  for (std::size_t f = 0; f < effects.size(); ++f) {
    const Interval95 interval = interval_of(shares[f]);
    effects[f].low = std::min(interval.from, effects[f].share);
    effects[f].high = std::max(interval.to, effects[f].share);
  }
}

/// Entries of the energy tables that decide the ranking, for each metric that has joules in it.
std::string band_text(const Results& results, const std::vector<std::string>& metrics, const std::vector<bool>& may) {
  EnergyBand band(results, may);
  std::string out;
  for (const std::string& metric : metrics) {
    const Objective objective(results, metric);
    if (!energy_metric(objective.column.name)) continue;
    const FigureNoise noise(results, objective.column, numbers_in(results, objective.column, may));
    out += "\n" + band.tornado_text(results, band.metric(noise.means(), objective.most));
  }
  if (out.empty()) {
    throw sim::InputError(
        fmt::format("--energy band: no metric has joules that draws tell of; allowed: {}", kEnergyMetrics));
  }
  return out;
}

}  // namespace

double Sensitivity::rest() const {
  double sum = noise;
  for (const Effect& effect : effects) sum += effect.share;
  return varies ? std::max(0.0, 1 - sum) : 0;
}

std::string Effect::interval_text() const { return fmt::format("{:.1f} .. {:.1f} %", 100 * low, 100 * high); }

Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& may) {
  const Column column = results.column(metric);
  const std::vector<std::size_t> rows = numbers_in(results, column, may);
  const FigureNoise noise(results, column, rows);
  std::vector<double> values, variances;
  for (const std::size_t row : rows) {
    values.push_back(amount_of(noise.means().values[row])->value);
    variances.push_back(noise.error(row) * noise.error(row));
  }
  const Factors factors = find_factors(results, rows);
  Sensitivity s{column.name, rows.size(), mean_of(values), false, factors.is_grid, {}, 0, {}};
  for (double& value : values) value -= s.mean;
  const double total = squares(values);
  s.varies = total > 0;
  const Shares shares = shares_of(factors, values, mean_of(variances));
  if (noise.is_noisy() && s.varies) {
    s.noise_text = noise.text();
    double sum = 0;
    for (const double share : shares.axes) sum += share;
    s.noise = std::min(shares.noise, std::max(0.0, 1 - sum));
  }
  const AdditiveModel model(factors.list, values);
  for (std::size_t f = 0; f < factors.list.size(); ++f) {
    const Factor& factor = factors.list[f];
    Effect effect{factor.name,    factor.levels,  model.effects(f), 0,
                  shares.axes[f], shares.axes[f], shares.axes[f],   factor.at};
    const auto [low, high] = std::ranges::minmax(effect.means);
    if (s.mean != 0) effect.range = (high - low) / std::abs(s.mean);
    for (double& mean : effect.means) mean += s.mean;
    s.effects.push_back(std::move(effect));
  }
  if (!s.noise_text.empty()) find_intervals(factors, values, variances, s.effects);
  std::ranges::stable_sort(s.effects, std::greater(), &Effect::share);
  return s;
}

std::string sensitivity_text(const Results& results, std::vector<std::string> metrics,
                             const std::vector<std::string>& where, bool band) {
  if (metrics.empty()) {
    for (const char* path : kUsualFigures) {
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
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < may.size(); ++row) {
    if (may[row] && results.rows()[row].is_done()) rows.push_back(row);
  }
  out += extrapolated_note(results, rows);
  const std::string missing = results.what_is_missing();
  if (metrics.empty()) throw sim::InputError(missing.empty() ? "no point has a metric" : missing);
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

}  // namespace tools::results
