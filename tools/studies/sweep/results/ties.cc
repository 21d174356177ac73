#include "tools/studies/sweep/results/ties.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/sensitivity.h"

namespace tools::results {
namespace {

constexpr std::size_t kShown = 20;
constexpr double kLittle = 0.05;  // share of the variance below which an axis matters little

/// The points that tie, the first among them, with the axes in which they differ.
std::string list_text(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& rows) {
  std::vector<Column> columns;
  std::vector<std::string> header = {"point"};
  for (const Column& axis : results.varying()) {
    const Value& first = axis.values[rows.front()];
    if (std::ranges::all_of(rows, [&](std::size_t r) { return axis.values[r] == first; })) continue;
    columns.push_back(axis);
    header.push_back(sim::printable(axis.name));
  }
  columns.push_back(noise.means());
  header.push_back(shown_name(noise.means()));
  header.emplace_back("95 %");
  sim::Table table(header);
  const std::vector<std::size_t> listed(rows.begin(),
                                        rows.begin() + static_cast<std::ptrdiff_t>(std::min(rows.size(), kShown)));
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) cells.push_back(shown_cells(column, listed));
  for (std::size_t i = 0; i < listed.size(); ++i) {
    std::vector<std::string> line = {std::to_string(results.rows()[listed[i]].n)};
    for (const std::vector<std::string>& column : cells) line.push_back(column[i]);
    line.push_back(give_or_take(noise, listed[i]));
    table.add_row(std::move(line));
  }
  return table.text() + (rows.size() > kShown ? fmt::format("and {} more\n", rows.size() - kShown) : "");
}

/// Values of each axis that are among the ties. An axis of which all values are does not matter for the first place if
/// it surely explains next to nothing of the figure, else noise hides its best value; one whose values are not all
/// there and that explains next to nothing matters little, however sure its effect is.
std::string axes_text(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& candidates,
                      const std::vector<std::size_t>& ties) {
  std::vector<bool> may(results.rows().size());
  for (const std::size_t row : candidates) may[row] = true;
  sim::Table table({"axis", "values that tie", "of", "share of variance", "95 %"});
  std::vector<std::string> matter, little, do_not, hidden;
  const Sensitivity sensitivity = find_sensitivity(results, noise.means().name, may);
  for (const Effect& effect : sensitivity.effects) {
    std::set<std::size_t> here;
    for (const std::size_t row : ties) {
      here.insert(effect.at[static_cast<std::size_t>(std::ranges::find(candidates, row) - candidates.begin())]);
    }
    std::vector<std::string> names;
    for (const std::size_t level : here) names.push_back(effect.levels[level]);
    const bool all = here.size() == effect.levels.size();
    auto& verdict = all ? (effect.high < kLittle ? do_not : hidden) : (effect.share < kLittle ? little : matter);
    verdict.push_back(effect.axis);
    table.add_row({effect.axis, all ? "all" : fmt::format("{}", fmt::join(names, ", ")),
                   fmt::format("{}", effect.levels.size()), fmt::format("{:.1f} %", 100 * effect.share),
                   effect.interval_text()});
  }
  std::string out = "\n" + table.text();
  if (!sensitivity.is_grid) out += fmt::format("the points are {}\n", kNoGrid);
  out += "\n";
  if (!matter.empty()) out += fmt::format("matters for the first place: {}\n", fmt::join(matter, ", then "));
  if (!little.empty()) {
    out +=
        fmt::format("matters little, less than {:.0f} % of the variance: {}\n", 100 * kLittle, fmt::join(little, ", "));
  }
  if (!hidden.empty()) {
    out += fmt::format("noise hides which value is best, more replicates may tell: {}\n", fmt::join(hidden, ", "));
  }
  if (!do_not.empty()) out += fmt::format("does not matter there: {}\n", fmt::join(do_not, ", "));
  return out;
}

}  // namespace

std::vector<std::size_t> ties_with(const FigureNoise& noise, bool most, const std::vector<std::size_t>& candidates,
                                   std::size_t first) {
  std::vector<std::size_t> others, ties;
  std::vector<double> chances;
  for (const std::size_t row : candidates) {
    if (row == first) continue;
    others.push_back(row);
    chances.push_back(noise.chance_better(first, row, most));
  }
  const std::vector<bool> worse = rejected(chances, kError);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.push_back(others[i]);
  }
  const auto number = [&](std::size_t row) { return amount_of(noise.means().values[row])->value; };
  std::ranges::stable_sort(
      ties, [&](std::size_t a, std::size_t b) { return most ? number(a) > number(b) : number(a) < number(b); });
  return ties;
}

std::string ties_text(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& candidates,
                      std::size_t first, const std::vector<std::size_t>& ties) {
  std::vector<std::size_t> rows = {first};
  rows.insert(rows.end(), ties.begin(), ties.end());
  std::string out;
  if (ties.empty()) {
    out = "no other point ties with it (95 %, all points together)";
  } else {
    out = fmt::format("{} point{} with it (95 %, all points together)", ties.size(),
                      ties.size() == 1 ? " ties" : "s tie");
  }
  out += fmt::format("; {}\n", noise.text());
  if (!ties.empty()) out += "\n" + list_text(results, noise, rows);
  return out + axes_text(results, noise, candidates, rows);
}

}  // namespace tools::results
