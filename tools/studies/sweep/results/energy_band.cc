#include "tools/studies/sweep/results/energy_band.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {
namespace {

constexpr std::size_t kRivals = 6;  ///< rows of a table of the best points
constexpr std::size_t kBars = 12;   ///< rows of a tornado table

std::string percent_text(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string sample_interval_text(const std::vector<double>& samples) {
  const Interval95 i = interval_of(samples);
  return fmt::format("{} .. {}", number_text(i.from), number_text(i.to));
}

/// Returns the axis values of a row as text: "cores=2 tni.trvs=4".
std::string label_of(const std::vector<Column>& varying, std::size_t row) {
  std::string out;
  for (const Column& column : varying) {
    if (is_absent(column.values[row])) continue;
    out += fmt::format("{}{}={}", out.empty() ? "" : " ", column.name, exact_text(column.values[row]));
  }
  return sim::printable(out, 60);
}

/// Returns the share of all pairs of points that the values `b` order differently from the values `a`.
double share_of_reordered_pairs(const std::vector<double>& a, const std::vector<double>& b) {
  std::size_t pairs = 0, other = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = i + 1; k < a.size(); ++k, ++pairs) other += (a[i] < a[k]) != (b[i] < b[k]) ? 1 : 0;
  }
  return pairs == 0 ? 0 : static_cast<double>(other) / static_cast<double>(pairs);
}

std::size_t best_of(const BandedMetric& m, const std::vector<double>& values) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (m.is_better(values[i], values[best])) best = i;
  }
  return best;
}

}  // namespace

std::vector<std::size_t> BandedMetric::rank_points() const {
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return is_better(nominal[a], nominal[b]); });
  return order;
}

std::string BandedMetric::ratio_text(std::size_t point, std::size_t other) const {
  return fmt::format("{:.3f} / {:.3f} / {:.3f}", at_low[point] / at_low[other], nominal[point] / nominal[other],
                     at_high[point] / at_high[other]);
}

EnergyBand::EnergyBand(const Results& results, const std::vector<std::size_t>& rows) {
  for (const std::size_t row : rows) {
    if (!results.rows()[row].is_done()) continue;
    rows_.push_back(row);
    runs_.push_back(std::make_unique<PricedRun>(load_report(results.folder_of(results.rows()[row]))));
  }
  if (rows_.empty()) throw sim::InputError("no point has a report to be priced");
}

namespace {

/// Evaluates a point of a metric, or a machine over its workloads.
/// `value_of_run`: value of a run by its number.
double evaluate_banded(const BandedMetric& metric, std::size_t point, auto&& value_of_run) {
  const std::vector<std::size_t>& runs = metric.runs[point];
  if (!metric.fold || runs.size() == 1) return value_of_run(runs.front());
  std::vector<double> values;
  for (const std::size_t run : runs) values.push_back(value_of_run(run));
  return *sweep::fold_workloads(metric.fold->metric.kind, values, metric.fold->larger_is_better);
}

}  // namespace

std::vector<std::size_t> EnergyBand::find_runs(const Results& results, const Column& column, std::size_t row) const {
  const MachineSet& machines = results.machines();
  std::vector<std::optional<std::size_t>> points = {row};
  if (column.fold) points = machines.rows[machines.machine_of[row]];
  const auto is_needed = [&](std::size_t workload) {
    const bool is_of_one = column.fold && column.fold->metric.kind == sweep::SetMetric::Kind::kOn;
    return !is_of_one || machines.workloads[workload] == column.fold->metric.workload;
  };
  std::vector<std::size_t> runs;
  for (std::size_t w = 0; w < points.size(); ++w) {
    if (!is_needed(w)) continue;
    const auto run = points[w] ? std::ranges::lower_bound(rows_, *points[w]) : rows_.end();
    if (run == rows_.end() || *run != *points[w]) return {};
    runs.push_back(static_cast<std::size_t>(run - rows_.begin()));
  }
  return runs;
}

BandedMetric EnergyBand::price_metric(const Results& results, const Column& column, bool more_is_better,
                                      const std::vector<std::size_t>& rows) {
  const Column& points = column.fold ? column.fold->points : column;
  const std::optional<EnergyMetric> joules = energy_metric(points.name);
  BandedMetric out;
  out.name = shown_name(column);
  out.path = points.name;
  out.more_is_better = more_is_better;
  out.fold = column.fold;
  for (const std::size_t row : rows) {
    std::vector<std::size_t> runs = find_runs(results, column, row);
    if (runs.empty() || !magnitude_of(column.values[row])) continue;
    out.rows.push_back(row);
    out.runs.push_back(std::move(runs));
  }
  std::vector<double> low(rows_.size()), high(rows_.size());
  std::vector<std::vector<double>> drawn(rows_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::optional<sweep::Magnitude> number = magnitude_of(points.values[rows_[i]]);
    out.run_values.push_back(number ? number->value : 0);
    low[i] = high[i] = out.run_values[i];
    if (!number) continue;
    if (!joules) {
      drawn[i].assign(kEnergyDraws, number->value);
      continue;
    }
    const double nominal = nominal_energy_pj(*runs_[i], joules->block);
    const auto figure = [&](double pj) { return number->value * (joules->inverse ? nominal / pj : pj / nominal); };
    low[i] = figure(band_energy_pj(*runs_[i], joules->block, &sim::Band::low));
    high[i] = figure(band_energy_pj(*runs_[i], joules->block, &sim::Band::high));
    drawn[i] = energy_by_draw_pj(*runs_[i], joules->block);
    for (double& pj : drawn[i]) pj = figure(pj);
  }
  for (std::size_t point = 0; point < out.rows.size(); ++point) {
    const auto value_among = [&](const std::vector<double>& by_run) {
      return evaluate_banded(out, point, [&](std::size_t run) { return by_run[run]; });
    };
    out.nominal.push_back(value_among(out.run_values));
    out.at_low.push_back(value_among(low));
    out.at_high.push_back(value_among(high));
    std::vector<double>& draws = out.drawn.emplace_back();
    for (std::uint64_t draw = 0; draw < kEnergyDraws; ++draw) {
      draws.push_back(evaluate_banded(out, point, [&](std::size_t run) { return drawn[run][draw]; }));
    }
  }
  if (out.rows.empty()) throw sim::InputError(fmt::format("no point has {} as a number", shown_name(column)));
  return out;
}

namespace {

/// Returns how the points of a metric are numbered: as machines for a function over workloads.
RankedRows ranked_rows_of(const Results& results, const BandedMetric& metric) {
  return {metric.fold != nullptr && results.machines().is_set(), {}};
}

}  // namespace

std::string EnergyBand::best_text(const Results& results, const BandedMetric& m) const {
  const std::vector<std::size_t> order = m.rank_points();
  std::vector<std::size_t> wins(m.rows.size());
  for (std::uint64_t draw = 0; draw < kEnergyDraws; ++draw) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < m.rows.size(); ++i) {
      if (m.is_better(m.drawn[i][draw], m.drawn[best][draw])) best = i;
    }
    ++wins[best];
  }
  const RankedRows ranked = ranked_rows_of(results, m);
  const std::vector<Column> varying = ranked.varying_axes(results);
  sim::Table table({"", ranked.noun(), m.name, "95 % interval", "best in", "over the best, low / nominal / high tables",
                    "95 % interval", "better in"});
  for (std::size_t rank = 0; rank < std::min(order.size(), kRivals); ++rank) {
    const std::size_t i = order[rank];
    std::vector<double> ratios;
    std::size_t better = 0;
    for (std::uint64_t draw = 0; draw < kEnergyDraws; ++draw) {
      const double mine = m.drawn[i][draw], leader = m.drawn[order.front()][draw];
      ratios.push_back(mine / leader);
      better += m.is_better(mine, leader) ? 1 : 0;
    }
    const auto share = [](std::size_t n) { return percent_text(static_cast<double>(n) / double{kEnergyDraws}); };
    table.add_row({label_of(varying, m.rows[i]), fmt::format("{}", ranked.number_of(results, m.rows[i])),
                   number_text(m.nominal[i]), sample_interval_text(m.drawn[i]), share(wins[i]),
                   rank == 0 ? "" : m.ratio_text(i, order.front()), rank == 0 ? "" : sample_interval_text(ratios),
                   rank == 0 ? "" : share(better)});
  }
  return fmt::format("under {} draws of the energy tables, {} {}s\n\n{}", kEnergyDraws, m.rows.size(), ranked.noun(),
                     table.text());
}

std::vector<double> EnergyBand::shares_on_front(const BandedMetric& x, const BandedMetric& y) {
  std::vector<double> shares(x.rows.size());
  std::vector<std::size_t> order(x.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::uint64_t draw = 0; draw < kEnergyDraws; ++draw) {
    const auto at = [draw](const BandedMetric& m, std::size_t i) { return m.drawn[i][draw]; };
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
      return at(x, a) != at(x, b) ? x.is_better(at(x, a), at(x, b)) : y.is_better(at(y, a), at(y, b));
    });
    std::optional<std::size_t> last;
    for (const std::size_t i : order) {
      const bool is_equal = last && at(x, i) == at(x, *last) && at(y, i) == at(y, *last);
      if (last && !is_equal && !y.is_better(at(y, i), at(y, *last))) continue;
      shares[i] += 1 / double{kEnergyDraws};
      last = i;
    }
  }
  return shares;
}

std::vector<double> EnergyBand::factors_at(const EnergyMetric& metric, const std::string& entry, double quantile) {
  std::vector<double> out;
  for (const auto& run : runs_) {
    const double nominal = nominal_energy_pj(*run, metric.block);
    set_single_entry(*run, entry, quantile);
    const double pj = nominal_energy_pj(*run, metric.block);
    out.push_back(metric.inverse ? nominal / pj : pj / nominal);
    run->restore_nominal();
  }
  return out;
}

std::string EnergyBand::tornado_text(const Results& results, const BandedMetric& m) {
  const std::optional<EnergyMetric> joules = energy_metric(m.path);
  if (!joules) throw sim::InputError(fmt::format("{} has no joules in it, so no energy table moves it", m.name));
  const RankedRows ranked = ranked_rows_of(results, m);
  if (m.rows.size() < 2) throw sim::InputError(fmt::format("a ranking needs two {}s", ranked.noun()));
  std::vector<PricedRun*> all;
  for (const auto& run : runs_) all.push_back(run.get());
  const std::vector<std::size_t> order = m.rank_points();
  const std::size_t first = order[0], second = order[1];
  struct Bar {
    std::string entry;
    double at_low, at_high, turned;
    std::size_t best_low, best_high;
    double swing_size() const { return std::abs(std::log(at_high / at_low)); }
  };
  std::vector<Bar> bars;
  for (const std::string& entry : entries_of(all)) {
    const auto values_at = [&](double quantile) {
      const std::vector<double> factors = factors_at(*joules, entry, quantile);
      std::vector<double> values;
      for (std::size_t i = 0; i < m.rows.size(); ++i) {
        values.push_back(evaluate_banded(m, i, [&](std::size_t run) { return m.run_values[run] * factors[run]; }));
      }
      return values;
    };
    const std::vector<double> low = values_at(0), high = values_at(1);
    bars.push_back({entry, low[second] / low[first], high[second] / high[first], share_of_reordered_pairs(low, high),
                    best_of(m, low), best_of(m, high)});
  }
  std::erase_if(bars, [](const Bar& bar) { return bar.at_low == bar.at_high && bar.turned == 0; });
  std::ranges::stable_sort(bars, [](const Bar& a, const Bar& b) {
    return a.turned != b.turned ? a.turned > b.turned : a.swing_size() > b.swing_size();
  });
  const auto n = [&](std::size_t i) { return ranked.number_of(results, m.rows[i]); };
  sim::Table table({"entry of the tables", "ratio at low", "at high", "best at low", "at high", "pairs turned"});
  for (std::size_t i = 0; i < std::min(bars.size(), kBars); ++i) {
    const Bar& bar = bars[i];
    table.add_row({bar.entry, fmt::format("{:.4f}", bar.at_low), fmt::format("{:.4f}", bar.at_high),
                   fmt::format("{}", n(bar.best_low)), fmt::format("{}", n(bar.best_high)), percent_text(bar.turned)});
  }
  return fmt::format(
      "{}: what decides the ranking; ratio: {} {} over {} {}, "
      "the best two, {:.4f} by nominal tables; one entry at a "
      "time, all others nominal\n\n{}",
      m.name, ranked.noun(), n(second), ranked.noun(), n(first), m.nominal[second] / m.nominal[first], table.text());
}

}  // namespace tools::results
