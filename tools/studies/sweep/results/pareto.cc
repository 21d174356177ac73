#include "tools/studies/sweep/results/pareto.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "sim/error.h"
#include "tools/analysis/report_paths.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/notes.h"
#include "tools/studies/sweep/results/results_table.h"

namespace tools::results {
namespace {

/// Better high, but for some below them.
constexpr std::array<std::string_view, 4> kBetterHigh = {"totals.perf.", "totals.relative.", "totals.psnr_db",
                                                         "totals.utilisation."};
constexpr std::array<std::string_view, 5> kBetterLow = {"totals.perf.nj_per_ray", "totals.relative.traversal_steps",
                                                        "totals.relative.dram_bytes", "totals.relative.tni_power",
                                                        "totals.relative.rays"};

bool is_better_high(std::string_view path) {
  const auto begins = [&](std::string_view prefix) { return path.starts_with(prefix); };
  return std::ranges::any_of(kBetterHigh, begins) && std::ranges::none_of(kBetterLow, begins);
}

std::string path_of(std::string_view text) {
  return std::string(text.starts_with("min:") || text.starts_with("max:") ? text.substr(4) : text);
}

/// Marks of the points on the Pareto front, with "~" those that may not be, and near it.
Column letters_of(const ParetoFront& front, std::size_t rows, bool csv) {
  Column letters{"", std::vector<Value>(rows)};
  for (std::size_t i = 0; i < front.rows.size(); ++i) {
    letters.values[front.rows[i]] = std::string(1, front.mark(i)) + (csv || front.sure[i] ? "" : "~");
  }
  for (const std::size_t row : front.near) letters.values[row] = std::string("~");
  return letters;
}

/// Two figures of the same points under draws of the energy tables.
struct Draws2d {
  BandedMetric x, y;
  std::vector<std::size_t> at;  ///< by row: where it stands in both

  /// Share of the draws in which one row is as good in both and better in one.
  double dominates(std::size_t better, std::size_t worse) const {
    const std::size_t b = at[better], w = at[worse];
    std::size_t count = 0;
    for (std::uint64_t draw = 0; draw < kEnergyDraws; ++draw) {
      const double xb = x.drawn[b][draw], xw = x.drawn[w][draw], yb = y.drawn[b][draw], yw = y.drawn[w][draw];
      const bool as_good = !x.is_better(xw, xb) && !y.is_better(yw, yb);
      count += as_good && (xb != xw || yb != yw) ? 1 : 0;
    }
    return static_cast<double>(count) / double{kEnergyDraws};
  }
};

Draws2d drawn(const Results& results, const Objective& x, const Objective& y, const ParetoFront& front) {
  if (!energy_metric(x.column.name) && !energy_metric(y.column.name)) {
    throw sim::InputError(fmt::format("--energy band: neither {} nor {} has joules that draws tell of; allowed: {}",
                                      shown_name(x.column), shown_name(y.column), kEnergyMetrics));
  }
  std::vector<bool> may(results.rows().size());
  for (const std::size_t row : front.all()) may[row] = true;
  EnergyBand band(results, may);
  Draws2d out{band.metric(x.column, x.most), band.metric(y.column, y.most), std::vector<std::size_t>(may.size())};
  for (std::size_t i = 0; i < out.x.rows.size(); ++i) out.at[out.x.rows[i]] = i;
  return out;
}

/// Share of the draws on whose front each row is, for people as "86.5 %".
Column shares_of(const Draws2d& draws, std::size_t rows, bool csv) {
  Column shares{"on the front in", std::vector<Value>(rows)};
  const std::vector<double> found = EnergyBand::shares_on_front(draws.x, draws.y);
  for (std::size_t i = 0; i < found.size(); ++i) {
    shares.values[draws.x.rows[i]] = csv ? Value(found[i]) : Value(fmt::format("{:.1f} %", 100 * found[i]));
  }
  return shares;
}

/// For each figure with joules, every row over the best one, under all low, nominal and high tables.
void add_ratios(const Draws2d& draws, std::size_t rows, std::vector<Column>& columns) {
  for (const BandedMetric* metric : {&draws.x, &draws.y}) {
    if (!energy_metric(metric->name)) continue;
    Column ratios{fmt::format("{} over the best, low / nominal / high tables", metric_name(metric->name)),
                  std::vector<Value>(rows)};
    const std::size_t best = metric->ranking().front();
    for (std::size_t i = 0; i < metric->rows.size(); ++i) {
      ratios.values[metric->rows[i]] = metric->ratio_text(i, best);
    }
    columns.push_back(std::move(ratios));
  }
}

/// Noise of a figure, if it has any, in a line.
std::string noise_line(const Objective& objective, const FigureNoise& noise) {
  return noise.is_noisy() ? fmt::format("{}: {}\n", shown_name(objective.column), noise.text()) : std::string();
}

}  // namespace

Objective::Objective(const Results& results, const std::string& text)
    : column(results.column(path_of(text))),
      most(text.starts_with("max:") || (!text.starts_with("min:") && is_better_high(column.name))) {}

std::optional<double> Objective::of(std::size_t row) const {
  const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
  return number ? std::optional(number->value) : std::nullopt;
}

std::string Objective::text() const {
  return fmt::format("{} ({} is better)", shown_name(column), most ? "more" : "less");
}

std::vector<std::size_t> ParetoFront::all() const {
  std::vector<std::size_t> rows_of_both = rows;
  rows_of_both.insert(rows_of_both.end(), other.begin(), other.end());
  return rows_of_both;
}

char ParetoFront::mark(std::size_t i) const {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  return rows.size() <= kLetters.size() ? kLetters[i] : '#';
}

ParetoFront pareto_front(const Objective& x, const Objective& y, const std::vector<bool>& may) {
  struct Point {
    std::size_t row;
    double x, y;
  };
  std::vector<Point> points;
  for (std::size_t row = 0; row < may.size(); ++row) {
    const auto at_x = x.of(row), at_y = y.of(row);
    if (may[row] && at_x && at_y) points.push_back({row, *at_x, *at_y});
  }
  std::ranges::stable_sort(points, [&](const Point& a, const Point& b) {
    return a.x != b.x ? x.is_better(a.x, b.x) : y.is_better(a.y, b.y);
  });
  ParetoFront front;
  const Point* last = nullptr;  // the best in y so far
  for (const Point& point : points) {
    const bool is_equal = last != nullptr && point.x == last->x && point.y == last->y;
    const bool is_on_it = last == nullptr || is_equal || y.is_better(point.y, last->y);
    (is_on_it ? front.rows : front.other).push_back(point.row);
    if (is_on_it) last = &point;
  }
  return front;
}

std::vector<std::size_t> near_front(const Objective& x, const Objective& y, const FigureNoise& x_noise,
                                    const FigureNoise& y_noise, const ParetoFront& front,
                                    const std::function<bool(std::size_t better, std::size_t worse)>& sure) {
  const std::vector<std::size_t> all = front.all();
  const double level = kError / static_cast<double>(all.size());
  const auto is_as_good = [&](const Objective& o, const FigureNoise& noise, std::size_t better, std::size_t worse) {
    return noise.chance_better(better, worse, o.most) <= level || (!noise.is_noisy() && *o.of(better) == *o.of(worse));
  };
  const auto beats = [&](std::size_t better, std::size_t worse) {
    if (*x.of(better) == *x.of(worse) && *y.of(better) == *y.of(worse)) return false;
    return is_as_good(x, x_noise, better, worse) && is_as_good(y, y_noise, better, worse) &&
           (!sure || sure(better, worse));
  };
  std::vector<std::size_t> near;
  for (const std::size_t row : front.other) {
    if (std::ranges::none_of(all, [&](std::size_t other) { return beats(other, row); })) near.push_back(row);
  }
  return near;
}

std::vector<bool> surely_on_front(const Objective& x, const Objective& y, const FigureNoise& x_noise,
                                  const FigureNoise& y_noise, const ParetoFront& front) {
  const std::vector<std::size_t> all = front.all();
  const double level = kError / (2 * static_cast<double>(all.size()));
  std::vector<bool> sure;
  for (const std::size_t row : front.rows) {
    sure.push_back(std::ranges::all_of(all, [&](std::size_t other) {
      const bool is_equal = *x.of(row) == *x.of(other) && *y.of(row) == *y.of(other);
      return is_equal || x_noise.chance_better(row, other, x.most) <= level ||
             y_noise.chance_better(row, other, y.most) <= level;
    }));
  }
  return sure;
}

std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width) {
  Objective x(results, options.x), y(results, options.y);
  const std::vector<bool> may = meeting(results, options.where);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < may.size(); ++row) {
    if (may[row] && x.of(row) && y.of(row)) rows.push_back(row);
  }
  const FigureNoise x_noise(results, x.column, rows), y_noise(results, y.column, rows);
  x.column = x_noise.means();
  y.column = y_noise.means();
  ParetoFront front = pareto_front(x, y, may);
  if (front.rows.empty()) {
    const std::string missing = results.what_is_missing();
    throw sim::InputError(fmt::format("no point has both {} and {}{}{}", shown_name(x.column), shown_name(y.column),
                                      options.where.empty() ? "" : " and meets --where",
                                      missing.empty() ? "" : "; " + missing));
  }
  std::optional<Draws2d> draws;
  std::function<bool(std::size_t, std::size_t)> sure;
  if (options.band) {
    draws = drawn(results, x, y, front);
    sure = [&](std::size_t better, std::size_t worse) { return draws->dominates(better, worse) >= 1 - kError; };
  }
  front.near = near_front(x, y, x_noise, y_noise, front, sure);
  front.sure = surely_on_front(x, y, x_noise, y_noise, front);
  std::vector<Column> columns = {letters_of(front, results.rows().size(), options.csv), results.column("n")};
  if (options.csv) {
    columns.front().name = "front";
    columns.push_back(results.column("id"));
  }
  const auto is_objective = [&](const Column& c) { return c.name == x.column.name || c.name == y.column.name; };
  for (Column& column : results.varying()) {
    if (!is_objective(column)) columns.push_back(std::move(column));
  }
  columns.push_back(x.column);
  columns.push_back(y.column);
  if (draws) columns.push_back(shares_of(*draws, results.rows().size(), options.csv));
  if (draws && !options.csv) add_ratios(*draws, results.rows().size(), columns);
  std::vector<std::size_t> shown = front.rows;
  shown.insert(shown.end(), front.near.begin(), front.near.end());
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(options.csv ? column.name : shown_name(column));
  const std::string table = table_text(names, columns, shown, options.csv);
  if (options.csv) return table;
  std::string out = pareto_plot(x, y, front, width) + noise_line(x, x_noise) + noise_line(y, y_noise) + "\n" + table;
  if (draws) out += draws_note({&x_noise, &y_noise});
  return out + extrapolated_note(results, rows);
}

}  // namespace tools::results
