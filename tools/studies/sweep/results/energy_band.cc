#include "tools/studies/sweep/results/energy_band.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
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

EnergyBand::EnergyBand(const Results& results, const std::vector<bool>& selected) {
  for (std::size_t row = 0; row < selected.size(); ++row) {
    if (!selected[row] || !results.rows()[row].is_done()) continue;
    rows_.push_back(row);
    runs_.push_back(std::make_unique<PricedRun>(load_report(results.folder_of(results.rows()[row]))));
  }
  if (rows_.empty()) throw sim::InputError("no point has a report to be priced");
}

BandedMetric EnergyBand::price_metric(const Column& column, bool more_is_better) {
  const std::optional<EnergyMetric> joules = energy_metric(column.name);
  BandedMetric out{column.name, more_is_better, {}, {}, {}, {}, {}};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const std::optional<sweep::Magnitude> number = magnitude_of(column.values[rows_[i]]);
    if (!number) continue;
    out.rows.push_back(rows_[i]);
    out.nominal.push_back(number->value);
    if (!joules) {
      out.drawn.emplace_back(kEnergyDraws, number->value);
      out.at_low.push_back(number->value);
      out.at_high.push_back(number->value);
      continue;
    }
    const double nominal = nominal_energy_pj(*runs_[i], joules->block);
    const auto figure = [&](double pj) { return number->value * (joules->inverse ? nominal / pj : pj / nominal); };
    out.at_low.push_back(figure(side_energy_pj(*runs_[i], joules->block, &sim::Band::low)));
    out.at_high.push_back(figure(side_energy_pj(*runs_[i], joules->block, &sim::Band::high)));
    std::vector<double> drawn = energy_by_draw_pj(*runs_[i], joules->block);
    for (double& pj : drawn) pj = figure(pj);
    out.drawn.push_back(std::move(drawn));
  }
  if (out.rows.empty()) throw sim::InputError(fmt::format("no point has {} as a number", shown_name(column)));
  return out;
}

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
  const std::vector<Column> varying = results.varying_axes();
  sim::Table table({"", "point", metric_name(m.name), "95 % interval", "best in",
                    "over the best, low / nominal / high tables", "95 % interval", "better in"});
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
    table.add_row({label_of(varying, m.rows[i]), fmt::format("{}", results.rows()[m.rows[i]].n),
                   number_text(m.nominal[i]), sample_interval_text(m.drawn[i]), share(wins[i]),
                   rank == 0 ? "" : m.ratio_text(i, order.front()), rank == 0 ? "" : sample_interval_text(ratios),
                   rank == 0 ? "" : share(better)});
  }
  return fmt::format("under {} draws of the energy tables, {} points\n\n{}", kEnergyDraws, m.rows.size(), table.text());
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
  const std::optional<EnergyMetric> joules = energy_metric(m.name);
  if (!joules)
    throw sim::InputError(fmt::format("{} has no joules in it, so no energy table moves it", metric_name(m.name)));
  if (m.rows.size() < 2) throw sim::InputError("a ranking needs two points");
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
      for (std::size_t i = 0, run = 0; i < m.rows.size(); ++i, ++run) {
        while (rows_[run] != m.rows[i]) ++run;
        values.push_back(m.nominal[i] * factors[run]);
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
  const auto n = [&](std::size_t i) { return results.rows()[m.rows[i]].n; };
  sim::Table table({"entry of the tables", "ratio at low", "at high", "best at low", "at high", "pairs turned"});
  for (std::size_t i = 0; i < std::min(bars.size(), kBars); ++i) {
    const Bar& bar = bars[i];
    table.add_row({bar.entry, fmt::format("{:.4f}", bar.at_low), fmt::format("{:.4f}", bar.at_high),
                   fmt::format("{}", n(bar.best_low)), fmt::format("{}", n(bar.best_high)), percent_text(bar.turned)});
  }
  return fmt::format(
      "{}: what decides the ranking; ratio: point {} over point {}, the best two, {:.4f} by nominal tables; one entry "
      "at "
      "a time, all others nominal\n\n{}",
      metric_name(m.name), n(second), n(first), m.nominal[second] / m.nominal[first], table.text());
}

}  // namespace tools::results
