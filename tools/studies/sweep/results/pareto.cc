#include "tools/studies/sweep/results/pareto.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/results_table.h"

namespace tools::results {
namespace {

/// Better high, but for some below them.
constexpr std::array<std::string_view, 4> kBetterHigh = {"totals.perf.", "totals.relative.", "totals.psnr_db",
                                                         "totals.utilisation."};
constexpr std::array<std::string_view, 4> kBetterLow = {"totals.perf.nj_per_ray", "totals.relative.traversal_steps",
                                                        "totals.relative.tni_power", "totals.relative.rays"};

bool is_better_high(std::string_view path) {
  const auto begins = [&](std::string_view prefix) { return path.starts_with(prefix); };
  return std::ranges::any_of(kBetterHigh, begins) && std::ranges::none_of(kBetterLow, begins);
}

std::string path_of(std::string_view text) {
  return std::string(text.starts_with("min:") || text.starts_with("max:") ? text.substr(4) : text);
}

/// Marks of the points on the Pareto front.
Column letters_of(const ParetoFront& front, std::size_t rows) {
  Column letters{"", std::vector<Value>(rows)};
  for (std::size_t i = 0; i < front.rows.size(); ++i) letters.values[front.rows[i]] = std::string(1, front.mark(i));
  return letters;
}

/// Points that are on the front of two figures in at least one draw in twenty, and how often.
struct UnsureFront {
  std::vector<std::size_t> rows;
  Column shares;
};

UnsureFront unsure_front(const Results& results, const Objective& x, const Objective& y, const ParetoFront& front) {
  constexpr double kSeldom = 0.05;
  if (!energy_metric(x.column.name) && !energy_metric(y.column.name)) {
    throw sim::InputError(
        fmt::format("--energy band: neither {} nor {} has joules in it", x.column.name, y.column.name));
  }
  std::vector<bool> may(results.rows().size());
  for (const auto* rows : {&front.rows, &front.other}) {
    for (const std::size_t row : *rows) may[row] = true;
  }
  EnergyBand band(results, may);
  const BandedMetric of_x = band.metric(x.column, x.most), of_y = band.metric(y.column, y.most);
  const std::vector<double> shares = EnergyBand::shares_on_front(of_x, of_y);
  UnsureFront out{front.rows, {"on the front in", std::vector<Value>(results.rows().size())}};
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const std::size_t row = of_x.rows[i];
    out.shares.values[row] = shares[i];
    const bool is_nominal = std::ranges::find(front.rows, row) != front.rows.end();
    if (!is_nominal && shares[i] >= kSeldom) out.rows.push_back(row);
  }
  return out;
}

}  // namespace

Objective::Objective(const Results& results, const std::string& text)
    : column(results.column(path_of(text))),
      most(text.starts_with("max:") || (!text.starts_with("min:") && is_better_high(column.name))) {}

std::optional<double> Objective::of(std::size_t row) const {
  const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
  return number ? std::optional(number->value) : std::nullopt;
}

std::string Objective::text() const { return fmt::format("{} ({} is better)", column.name, most ? "more" : "less"); }

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

std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width) {
  const Objective x(results, options.x), y(results, options.y);
  const ParetoFront front = pareto_front(x, y, meeting(results, options.where));
  if (front.rows.empty()) {
    const std::string missing = results.what_is_missing();
    throw sim::InputError(fmt::format("no point has both {} and {}{}{}", x.column.name, y.column.name,
                                      options.where.empty() ? "" : " and meets --where",
                                      missing.empty() ? "" : "; " + missing));
  }
  std::vector<Column> columns;
  if (!options.csv) columns.push_back(letters_of(front, results.rows().size()));
  columns.push_back(results.column("n"));
  if (options.csv) columns.push_back(results.column("id"));
  const auto is_objective = [&](const Column& c) { return c.name == x.column.name || c.name == y.column.name; };
  for (Column& column : results.varying()) {
    if (!is_objective(column)) columns.push_back(std::move(column));
  }
  columns.push_back(x.column);
  columns.push_back(y.column);
  std::vector<std::size_t> shown = front.rows;
  if (options.band) {
    UnsureFront unsure = unsure_front(results, x, y, front);
    shown = std::move(unsure.rows);
    columns.push_back(std::move(unsure.shares));
  }
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(options.csv ? column.name : sim::printable(column.name));
  const std::string table = table_text(names, columns, shown, options.csv);
  if (options.csv) return table;
  return pareto_plot(x, y, front, width) + "\n" + table;
}

}  // namespace tools::results
