#include "tools/studies/sweep/results/sensitivity.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/sweep/results/best.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {
namespace {

/// An axis of a sweep whose distinct values are levels, numbered in ascending order.
struct Factor {
  std::string name;
  std::vector<std::string> levels;
  std::vector<std::size_t> at;  ///< level of each point
};

/// The axes that vary among some points. Axes that always move together are one factor.
struct Factors {
  std::vector<Factor> list;
  bool is_grid = false;
};

constexpr std::size_t kMostGroups = 6;

struct ValueOrder {
  bool operator()(const Value& a, const Value& b) const { return sorts_before(a, b); }
};

Factor factor_of(const Column& column, const std::vector<std::size_t>& rows) {
  std::map<Value, std::size_t, ValueOrder> levels;
  for (const std::size_t row : rows) levels.emplace(column.values[row], 0);
  Factor factor{column.name, {}, {}};
  for (auto& [value, number] : levels) {
    number = factor.levels.size();
    factor.levels.push_back(is_absent(value) ? "-" : sim::printable(exact_text(value)));
  }
  for (const std::size_t row : rows) factor.at.push_back(levels.at(column.values[row]));
  return factor;
}

/// True if two axes divide the points into the same groups; if no two points share a value, also order them alike.
bool move_together(const Factor& a, const Factor& b) {
  if (a.levels.size() != b.levels.size()) return false;
  if (a.levels.size() == a.at.size()) return a.at == b.at;
  std::vector<std::size_t> partner(a.levels.size(), a.levels.size());
  for (std::size_t i = 0; i < a.at.size(); ++i) {
    std::size_t& of_a = partner[a.at[i]];
    if (of_a == a.levels.size()) of_a = b.at[i];
    if (of_a != b.at[i]) return false;
  }
  return true;  // both factors have the same number of levels
}

void join_equal_factors(std::vector<Factor>& factors) {
  for (std::size_t i = 0; i < factors.size(); ++i) {
    Factor& a = factors[i];
    for (std::size_t k = i + 1; k < factors.size();) {
      Factor& b = factors[k];
      if (!move_together(a, b)) {
        ++k;
        continue;
      }
      a.name += " + " + b.name;
      std::vector<std::string> joined = a.levels;
      for (std::size_t p = 0; p < a.at.size(); ++p) joined[a.at[p]] = a.levels[a.at[p]] + " / " + b.levels[b.at[p]];
      a.levels = std::move(joined);
      factors.erase(factors.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }
}

/// True if there is exactly one point for every combination of levels.
bool is_full_grid(const std::vector<Factor>& factors, std::size_t points) {
  std::size_t combinations = 1;
  for (const Factor& factor : factors) {
    combinations *= factor.levels.size();
    if (combinations > points) return false;
  }
  std::set<std::vector<std::size_t>> found;
  for (std::size_t i = 0; i < points; ++i) {
    std::vector<std::size_t> levels;
    for (const Factor& factor : factors) levels.push_back(factor.at[i]);
    found.insert(std::move(levels));
  }
  return combinations == points && found.size() == points;
}

/// Joins neighbouring levels of an axis into groups with about the same number of points.
void group_levels(Factor& factor, std::size_t groups) {
  std::vector<std::size_t> count(factor.levels.size()), group_of(factor.levels.size());
  for (const std::size_t level : factor.at) ++count[level];
  std::size_t before = 0;
  for (std::size_t level = 0; level < count.size(); ++level) {
    group_of[level] = (2 * before + count[level]) * groups / (2 * factor.at.size());
    before += count[level];
  }
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < count.size();) {
    std::size_t end = begin;
    while (end < count.size() && group_of[end] == group_of[begin]) ++end;
    names.push_back(end - begin == 1 ? factor.levels[begin]
                                     : fmt::format("{} to {}", factor.levels[begin], factor.levels[end - 1]));
    std::fill(group_of.begin() + static_cast<std::ptrdiff_t>(begin),
              group_of.begin() + static_cast<std::ptrdiff_t>(end), names.size() - 1);
    begin = end;
  }
  for (std::size_t& level : factor.at) level = group_of[level];
  factor.levels = std::move(names);
}

Factors find_factors(const std::vector<Column>& axes, const std::vector<std::size_t>& rows) {
  Factors factors;
  for (const Column& column : axes) {
    Factor factor = factor_of(column, rows);
    if (factor.levels.size() > 1) factors.list.push_back(std::move(factor));
  }
  join_equal_factors(factors.list);
  factors.is_grid = is_full_grid(factors.list, rows.size());
  if (factors.is_grid) return factors;
  const auto root = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(rows.size()))));
  const std::size_t groups = std::clamp<std::size_t>(root, 2, kMostGroups);
  for (Factor& factor : factors.list) {
    if (factor.levels.size() * 3 > rows.size() * 2 && factor.levels.size() > groups) group_levels(factor, groups);
  }
  join_equal_factors(factors.list);
  return factors;
}

constexpr const char* kUsualFigures[] = {"totals.cycles", "totals.energy_mj.nominal", "totals.power_w.nominal",
                                         "totals.perf.frames_per_joule_gpu"};
constexpr int kMostRounds = 1000;
constexpr double kConverged = 1e-12;  // relative change at which the fit has converged

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// Least-squares fit of the values by a sum of effects, one per factor (axis). Uses backfitting: each factor in turn is
/// fitted to the residuals of the others. On a full grid one round is exact.
class AdditiveModel {
 public:
  AdditiveModel(const std::vector<Factor>& factors, const std::vector<double>& deviations)
      : factors_(factors), deviations_(deviations), residuals_(deviations), effects_(factors.size()) {
    for (std::size_t f = 0; f < factors.size(); ++f) effects_[f].assign(factors[f].levels.size(), 0);
    const double scale = std::sqrt(sum_of_squares(residuals_));
    for (int round = 0; round < kMostRounds; ++round) {
      double change = 0;
      for (std::size_t f = 0; f < factors.size(); ++f) change = std::max(change, fit_factor(f));
      if (change <= kConverged * scale) return;
    }
  }

  const std::vector<double>& effects_of(std::size_t factor) const { return effects_[factor]; }
  double residual_squares() const { return sum_of_squares(residuals_); }
  /// Returns the sum of squares that a factor explains: the sum over all points of effect times value. The sums of all
  /// factors add up to what the model explains even if factors are correlated (Li et al., J. Phys. Chem. A 114, 2010).
  double explained_by(std::size_t factor) const {
    double sum = 0;
    const std::vector<std::size_t>& at = factors_[factor].at;
    for (std::size_t i = 0; i < at.size(); ++i) sum += effects_[factor][at[i]] * deviations_[i];
    return sum;
  }

 private:
  /// Fits the effects of one axis (factor) to the residuals of the others; returns the largest change of an effect.
  double fit_factor(std::size_t f) {
    const Factor& factor = factors_[f];
    std::vector<double> sums(factor.levels.size()), counts(factor.levels.size());
    for (std::size_t i = 0; i < residuals_.size(); ++i) {
      sums[factor.at[i]] += residuals_[i];
      ++counts[factor.at[i]];
    }
    double change = 0;
    for (std::size_t level = 0; level < sums.size(); ++level) {
      sums[level] /= counts[level];
      effects_[f][level] += sums[level];
      change = std::max(change, std::abs(sums[level]));
    }
    for (std::size_t i = 0; i < residuals_.size(); ++i) residuals_[i] -= sums[factor.at[i]];
    return change;
  }

  const std::vector<Factor>& factors_;
  const std::vector<double>& deviations_;
  std::vector<double> residuals_;
  std::vector<std::vector<double>> effects_;  ///< effects by factor, then by level
};

std::string share_text(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string sensitivity_table(const Sensitivity& s) {
  std::string out =
      fmt::format("{}: mean {} of {} {}s{}\n", s.metric, number_text(s.mean), s.points,
                  s.by_machine ? "machine" : "point", s.is_grid ? "" : fmt::format(", which are {}", kNoGrid));
  const bool noisy = !s.noise_text.empty();
  if (noisy) out += s.noise_text + "\n";
  std::vector<std::string> header = {"axis",         "levels", "lowest mean", "at",
                                     "highest mean", "at",     "range",       "share of variance"};
  if (noisy) header.emplace_back("95 %");
  sim::Table table(header);
  for (const Effect& e : s.effects) {
    const auto [low, high] = std::ranges::minmax_element(e.means);
    const auto level = [&](auto mean) { return e.levels[static_cast<std::size_t>(mean - e.means.begin())]; };
    std::vector<std::string> cells = {e.axis,
                                      fmt::format("{}", e.levels.size()),
                                      number_text(*low),
                                      level(low),
                                      number_text(*high),
                                      level(high),
                                      share_text(e.range),
                                      share_text(e.share)};
    if (noisy) cells.push_back(e.interval_text());
    table.add_row(std::move(cells));
  }
  const auto part = [&](const char* name, double share) {
    std::vector<std::string> cells = {name, "", "", "", "", "", "", share_text(share)};
    cells.resize(header.size());
    table.add_row(std::move(cells));
  };
  part("only together", s.share_of_interactions());
  if (noisy) part("noise", s.noise);
  return out + "\n" + table.text();
}

std::vector<std::size_t> rows_among(const std::vector<bool>& selected) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < selected.size(); ++row) {
    if (selected[row]) rows.push_back(row);
  }
  return rows;
}

/// Returns the selected rows that have a number in the column. Throws InputError if there is no such row.
std::vector<std::size_t> rows_with_numbers(const Column& column, const RankedRows& ranked, const Results& results) {
  std::vector<std::size_t> rows = rows_among(ranked.selected);
  std::erase_if(rows, [&](std::size_t row) {
    const bool has_result = ranked.by_machine || results.rows()[row].is_done();
    return !has_result || !magnitude_of(column.values[row]);
  });
  if (!rows.empty()) return rows;
  const std::string missing = results.missing_text();
  throw sim::InputError(fmt::format("no {} has {} as a number{}", ranked.noun(), shown_name(column),
                                    missing.empty() ? "" : "; " + missing));
}

/// The shares of a metric's variance that each axis and the noise explain.
struct VarianceShares {
  std::vector<double> axes;  ///< by factor
  double noise = 0;
};

/// Returns the shares of the variance that each axis and noise explain. For each degree of freedom of an axis, the
/// variance due to chance is subtracted. That is `variance` (the noise of a value), and at least the residual variance
/// if the grid is not full.
VarianceShares shares_of(const Factors& factors, const std::vector<double>& values, double variance) {
  const double total = sum_of_squares(values);
  VarianceShares out{std::vector<double>(factors.list.size()), 0};
  if (total == 0) return out;
  const AdditiveModel model(factors.list, values);
  std::size_t parameters = 1;
  for (const Factor& factor : factors.list) parameters += factor.levels.size() - 1;
  const bool adjusts = !factors.is_grid && values.size() > parameters;
  const double by_chance = adjusts ? model.residual_squares() / static_cast<double>(values.size() - parameters) : 0;
  for (std::size_t f = 0; f < factors.list.size(); ++f) {
    const double taken = std::max(by_chance, variance) * static_cast<double>(factors.list[f].levels.size() - 1);
    out.axes[f] = std::max(0.0, model.explained_by(f) - taken) / total;
  }
  out.noise = variance * static_cast<double>(values.size() - 1) / total;
  return out;
}

/// Returns a pseudo-random number of the standard normal distribution (Box and Muller, 1958).
double normal_draw(std::uint64_t draw, std::uint64_t point) {
  const auto uniform = [&](std::uint64_t which) {
    return (static_cast<double>(sim::hash(draw, point, which) >> 11) + 0.5) * 0x1p-53;
  };
  return std::sqrt(-2 * std::log(uniform(0))) * std::cos(2 * std::numbers::pi * uniform(1));
}

/// Computes 95 % intervals of the shares by parametric bootstrap: from values drawn at random around the measured ones.
void find_intervals(const Factors& factors, const std::vector<double>& values, const std::vector<double>& variances,
                    std::vector<Effect>& effects) {
  constexpr std::uint64_t kSweeps = 400;
  std::vector<std::vector<double>> shares(effects.size());
  for (std::uint64_t draw = 0; draw < kSweeps; ++draw) {
    std::vector<double> drawn = values;
    for (std::size_t i = 0; i < drawn.size(); ++i) drawn[i] += std::sqrt(variances[i]) * normal_draw(draw, i);
    const double mean = mean_of(drawn);
    for (double& value : drawn) value -= mean;
    const VarianceShares of_draw = shares_of(factors, drawn, 2 * mean_of(variances));
    // Drawn values contain the noise twice; measured values contain it once.
    const double scale = 1 / (1 - std::min(0.9, of_draw.noise / 2));
    for (std::size_t f = 0; f < effects.size(); ++f) shares[f].push_back(std::min(1.0, scale * of_draw.axes[f]));
  }
  for (std::size_t f = 0; f < effects.size(); ++f) {
    const Interval95 interval = interval_of(shares[f]);
    effects[f].low = std::min(interval.from, effects[f].share);
    effects[f].high = std::max(interval.to, effects[f].share);
  }
}

/// Returns the tornado tables of all metrics that contain energy: the energy entries that change the ranking most.
std::string tornado_tables(const Results& results, const std::vector<std::string>& metrics,
                           const std::vector<bool>& selected) {
  EnergyBand band(results, rows_among(selected));
  std::string out;
  for (const std::string& metric : metrics) {
    const Objective objective(results, metric);
    if (!energy_metric(report_path(objective.column))) continue;
    const RankedRows ranked = rows_to_rank(results, objective.column, selected);
    const std::vector<std::size_t> rows = rows_with_numbers(objective.column, ranked, results);
    const MetricNoise noise(results, objective.column, rows);
    const BandedMetric priced = band.price_metric(results, noise.means(), objective.more_is_better, rows);
    out += "\n" + band.tornado_text(results, priced);
  }
  if (out.empty()) {
    throw sim::InputError(
        fmt::format("--energy band: no metric depends on the energy tables; allowed: {}", kEnergyMetrics));
  }
  return out;
}

}  // namespace

double Sensitivity::share_of_interactions() const {
  double sum = noise;
  for (const Effect& effect : effects) sum += effect.share;
  return varies ? std::max(0.0, 1 - sum) : 0;
}

std::string Effect::interval_text() const { return fmt::format("{:.1f} .. {:.1f} %", 100 * low, 100 * high); }

Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& selected) {
  const Column column = results.column(metric);
  const RankedRows ranked = rows_to_rank(results, column, selected);
  const std::vector<std::size_t> rows = rows_with_numbers(column, ranked, results);
  const MetricNoise noise(results, column, rows);
  std::vector<double> values, variances;
  for (const std::size_t row : rows) {
    values.push_back(magnitude_of(noise.means().values[row])->value);
    variances.push_back(noise.error(row) * noise.error(row));
  }
  const Factors factors = find_factors(ranked.varying_axes(results), rows);
  Sensitivity s;
  s.metric = shown_name(column);
  s.points = rows.size();
  s.by_machine = ranked.by_machine;
  s.mean = mean_of(values);
  s.is_grid = factors.is_grid;
  for (double& value : values) value -= s.mean;
  const double total = sum_of_squares(values);
  s.varies = total > 0;
  const VarianceShares shares = shares_of(factors, values, mean_of(variances));
  if (noise.is_noisy() && s.varies) {
    s.noise_text = noise.describe();
    double sum = 0;
    for (const double share : shares.axes) sum += share;
    s.noise = std::min(shares.noise, std::max(0.0, 1 - sum));
  }
  const AdditiveModel model(factors.list, values);
  for (std::size_t f = 0; f < factors.list.size(); ++f) {
    const Factor& factor = factors.list[f];
    Effect effect{factor.name,    factor.levels,  model.effects_of(f), 0,
                  shares.axes[f], shares.axes[f], shares.axes[f],      factor.at};
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
  const std::vector<bool> selected = rows_meeting(results, where);
  std::string out;
  for (const std::string& metric : metrics) {
    if (!out.empty()) out += '\n';
    out += sensitivity_table(find_sensitivity(results, metric, selected));
  }
  if (band && !metrics.empty()) out += tornado_tables(results, metrics, selected);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < selected.size(); ++row) {
    if (selected[row] && results.rows()[row].is_done()) rows.push_back(row);
  }
  out += extrapolated_note(results, rows);
  const std::string missing = results.missing_text();
  if (metrics.empty()) throw sim::InputError(missing.empty() ? "no point has a metric" : missing);
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

}  // namespace tools::results
