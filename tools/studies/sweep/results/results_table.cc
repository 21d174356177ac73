#include "tools/studies/sweep/results/results_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/index/csv.h"

namespace tools::results {
namespace {

/// Shown where nobody says what to show.
constexpr const char* kUsualColumns[] = {"cycles", "perf.fps", "energy_mj.nominal", "power_w.nominal",
                                         "perf.frames_per_joule_gpu"};

/// Statistics that stand for a figure in tables for other programs, if there are any.
std::vector<std::string> statistics_of(const Results& results, const std::string& figure) {
  const std::string at = fmt::format("totals.replicates.figures.{}.", figure);
  if (!results.has_metric(at + "mean")) return {figure};
  return {at + "mean", at + "low", at + "high"};
}

std::vector<std::string> usual_columns(const Results& results, bool csv) {
  std::vector<std::string> names = {"n", "status"};
  for (const Column& column : results.varying()) names.push_back(column.name);
  for (const char* metric : kUsualColumns) {
    if (!results.has_metric(fmt::format("totals.{}", metric))) continue;
    for (std::string& name : csv ? statistics_of(results, metric) : std::vector<std::string>{metric}) {
      names.push_back(std::move(name));
    }
  }
  constexpr const char* kExtrapolated = "totals.extrapolated";
  const auto some = [](const Value& value) { return !is_absent(value) && exact_text(value) != "0"; };
  if (results.has_metric(kExtrapolated) && std::ranges::any_of(results.column(kExtrapolated).values, some)) {
    names.emplace_back("extrapolated");
  }
  return names;
}

/// A figure as people read it, "771200 ± 0.52 %", where all points that are done have replicates of it; else as it is.
Column with_interval(const Results& results, Column column) {
  if (!results.has_metric("totals.replicates.count")) return column;
  std::vector<std::size_t> done;
  for (std::size_t row = 0; row < results.rows().size(); ++row) {
    if (results.rows()[row].is_done() && !is_absent(column.values[row])) done.push_back(row);
  }
  const FigureNoise noise(results, column, done);
  if (!noise.is_measured()) return column;
  const std::vector<std::string> means = shown_cells(noise.means(), done);
  for (std::size_t i = 0; i < done.size(); ++i) {
    column.values[done[i]] = fmt::format("{} {}", means[i], give_or_take(noise, done[i]));
  }
  return column;
}

/// Absent values come last in both directions.
void sort_rows(std::vector<std::size_t>& rows, const Results& results, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string order = colon == std::string::npos ? "asc" : text.substr(colon + 1);
  if (order != "asc" && order != "desc") {
    throw sim::InputError(fmt::format("--sort '{}': the order '{}' is unknown; allowed: asc, desc",
                                      sim::printable(text), sim::printable(order)));
  }
  const Column column = column_of_means(results, text.substr(0, colon));
  std::ranges::stable_sort(rows, [&](std::size_t a, std::size_t b) {
    const Value &x = column.values[a], &y = column.values[b];
    if (is_absent(x) || is_absent(y)) return !is_absent(x) && is_absent(y);
    return order == "asc" ? is_before(x, y) : is_before(y, x);
  });
}

}  // namespace

std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv) {
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) {
    if (!csv) {
      cells.push_back(shown_cells(column, rows));
      continue;
    }
    cells.emplace_back();
    for (const std::size_t row : rows) cells.back().push_back(exact_text(column.values[row]));
  }
  sim::Table table(names);
  std::string lines = csv_line(names);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<std::string> row;
    for (std::vector<std::string>& column : cells) row.push_back(std::move(column[i]));
    if (csv) {
      lines += csv_line(row);
    } else {
      table.add_row(std::move(row));
    }
  }
  return csv ? lines : table.text();
}

std::string results_table(const Results& results, const TableOptions& options) {
  const std::vector<std::string> asked =
      options.columns.empty() ? usual_columns(results, options.csv) : options.columns;
  std::vector<std::string> names;
  std::vector<Column> columns;
  for (const std::string& name : asked) {
    columns.push_back(results.column(name));
    if (!options.csv) columns.back() = with_interval(results, std::move(columns.back()));
    names.push_back(options.csv ? columns.back().name : shown_name(columns.back()));
  }
  const std::vector<bool> met = meeting(results, options.where);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < met.size(); ++i) {
    if (met[i]) rows.push_back(i);
  }
  if (!options.sort.empty()) sort_rows(rows, results, options.sort);
  if (options.limit && rows.size() > *options.limit) rows.resize(*options.limit);
  const bool is_empty = rows.empty() && !options.where.empty() && !options.csv;
  return table_text(names, columns, rows, options.csv) + (is_empty ? "no point meets --where\n" : "");
}

}  // namespace tools::results
