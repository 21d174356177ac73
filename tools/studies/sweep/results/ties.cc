#include "tools/studies/sweep/results/ties.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/studies/sweep/results/cells.h"

namespace tools::results {
namespace {

constexpr double kError = 0.05;  ///< chance that any point is wrongly held to be worse
constexpr std::size_t kShown = 20;
constexpr std::string_view kTotals = "totals.";

/// Name of a figure of `totals`, or nothing.
std::string figure_of(const Column& metric) {
  return metric.name.starts_with(kTotals) ? metric.name.substr(kTotals.size()) : std::string();
}

double number_at(const Column& column, std::size_t row) {
  const std::optional<sweep::Magnitude> number = amount_of(column.values[row]);
  return number ? number->value : 0;
}

double noise_of(const Results& results, std::size_t row) {
  const ReportFile report = load_report(results.folder_of(results.rows()[row]));
  return default_noise(report.number("resolution[0]") * report.number("resolution[1]"));
}

}  // namespace

std::optional<ReplicatedMetric> replicated(const Results& results, const Column& metric,
                                           const std::vector<std::size_t>& rows) {
  const std::string at = "totals.replicates.figures." + figure_of(metric);
  if (!results.has_metric(at + ".mean") || !results.has_metric("totals.replicates.count")) return std::nullopt;
  ReplicatedMetric out{results.column(at + ".mean"), results.column(at + ".deviation"),
                       results.column("totals.replicates.count")};
  if (std::ranges::any_of(rows, [&](std::size_t row) { return is_absent(out.mean.values[row]); })) return std::nullopt;
  return out;
}

std::optional<Ties> ties_with(const Results& results, const Column& metric, bool most,
                              const std::vector<std::size_t>& candidates, std::size_t first) {
  if (candidates.size() < 2 || !is_noisy(figure_of(metric))) return std::nullopt;
  const std::optional<ReplicatedMetric> plays = replicated(results, metric, candidates);
  Ties ties{{}, plays.has_value(), plays ? 0 : noise_of(results, first)};
  const auto draws = [&](std::size_t row) {
    return Draws{static_cast<std::size_t>(number_at(plays->count, row)), number_at(plays->mean, row),
                 number_at(plays->deviation, row)};
  };
  const auto assumed = [&](std::size_t row) { return AssumedDraw{number_at(metric, row), ties.assumed}; };
  std::vector<std::size_t> others;
  std::vector<double> chances;
  for (const std::size_t row : candidates) {
    if (row == first) continue;
    MeanDifference d = plays ? difference_of(draws(row), draws(first)) : difference_of(assumed(row), assumed(first));
    if (!most) d.value = -d.value;
    others.push_back(row);
    chances.push_back(d.chance_above());
  }
  const std::vector<bool> worse = rejected(chances, kError);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.rows.push_back(others[i]);
  }
  const Column& shown = plays ? plays->mean : metric;
  std::ranges::stable_sort(ties.rows, [&](std::size_t a, std::size_t b) {
    return most ? number_at(shown, a) > number_at(shown, b) : number_at(shown, a) < number_at(shown, b);
  });
  return ties;
}

std::string ties_text(const Results& results, const Column& metric, std::size_t first, const Ties& ties) {
  const std::string source = ties.measured
                                 ? std::string("by replicates")
                                 : fmt::format(
                                       "with a noise of {:.2g} %, assumed for this size of picture; 'replicates' "
                                       "measure it",
                                       100 * ties.assumed);
  if (ties.rows.empty()) return fmt::format("no other point ties with it {} (95 %, all points together)\n", source);
  std::vector<std::size_t> rows = {first};
  rows.insert(rows.end(), ties.rows.begin(), ties.rows.end());
  const std::optional<ReplicatedMetric> plays =
      ties.measured ? replicated(results, metric, rows) : std::optional<ReplicatedMetric>{};
  std::vector<Column> columns;
  std::vector<std::string> shared;
  for (const Column& axis : results.varying()) {
    const bool same = std::ranges::all_of(rows, [&](std::size_t r) { return axis.values[r] == axis.values[first]; });
    if (same) {
      shared.push_back(fmt::format("{}={}", sim::printable(axis.name), sim::printable(exact_text(axis.values[first]))));
    } else {
      columns.push_back(axis);
    }
  }
  columns.push_back(plays ? plays->mean : metric);
  std::vector<std::string> header = {"point"};
  for (const Column& column : columns) header.push_back(sim::printable(column.name));
  sim::Table table(header);
  const std::vector<std::size_t> listed(rows.begin(), rows.begin() + std::min(rows.size(), kShown));
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) {
    std::vector<Value> values;
    for (const std::size_t row : listed) values.push_back(column.values[row]);
    cells.push_back(shown_cells(values));
  }
  for (std::size_t i = 0; i < listed.size(); ++i) {
    std::vector<std::string> line = {std::to_string(results.rows()[listed[i]].n)};
    for (const std::vector<std::string>& column : cells) line.push_back(column[i]);
    table.row(std::move(line));
  }
  std::string out = fmt::format("{} points tie with it {} (95 %, all points together):\n\n{}", ties.rows.size(), source,
                                table.text());
  if (rows.size() > kShown) out += fmt::format("and {} more\n", rows.size() - kShown);
  if (!shared.empty()) out += fmt::format("all of them have {}\n", fmt::join(shared, ", "));
  return out;
}

}  // namespace tools::results
