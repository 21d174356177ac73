#include "tools/studies/sweep/results/best.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/sensitivity.h"
#include "tools/studies/sweep/results/table.h"

namespace tools::results {
namespace {

constexpr std::size_t kShownTies = 20;
constexpr double kLittle = 0.05;  // share of the variance below which an axis matters little

/// Table of the points that tie, including the first, with the axes in which they differ.
std::string tie_table(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& rows) {
  std::vector<Column> columns;
  std::vector<std::string> header = {"point"};
  for (const Column& axis : results.varying_axes()) {
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
                                        rows.begin() + static_cast<std::ptrdiff_t>(std::min(rows.size(), kShownTies)));
  std::vector<std::vector<std::string>> cells;
  for (const Column& column : columns) cells.push_back(shown_cells(column, listed));
  for (std::size_t i = 0; i < listed.size(); ++i) {
    std::vector<std::string> line = {std::to_string(results.rows()[listed[i]].n)};
    for (const std::vector<std::string>& column : cells) line.push_back(column[i]);
    line.push_back(interval_text(noise, listed[i]));
    table.add_row(std::move(line));
  }
  return table.text() + (rows.size() > kShownTies ? fmt::format("and {} more\n", rows.size() - kShownTies) : "");
}

/// Table of the axes, each with its values among the ties, and a verdict on each axis:
/// 1. All values tie: the axis does not matter if it surely explains less than 5 % of the variance; otherwise noise
/// hides
///    its best value.
/// 2. Not all values tie: the axis matters, or matters little if it explains less than 5 % of the variance.
std::string axis_table(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& candidates,
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

std::vector<std::size_t> find_ties(const FigureNoise& noise, bool most, const std::vector<std::size_t>& candidates,
                                   std::size_t first) {
  std::vector<std::size_t> others, ties;
  std::vector<double> p_values;
  for (const std::size_t row : candidates) {
    if (row == first) continue;
    others.push_back(row);
    p_values.push_back(noise.p_value_better(first, row, most));
  }
  const std::vector<bool> worse = reject_hypotheses(p_values, kError);
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
  out += fmt::format("; {}\n", noise.describe());
  if (!ties.empty()) out += "\n" + tie_table(results, noise, rows);
  return out + axis_table(results, noise, candidates, rows);
}

namespace {

/// Returns the command that runs a point again from its stored configuration.
std::string rerun_command(sweep::Point point, const std::string& config) {
  point.config = config;
  point.sets.clear();
  for (std::string* in_config : {&point.scene, &point.camera, &point.frames, &point.resolution}) in_config->clear();
  return command_text(point.run_options().argv);
}

/// Returns the settings of a point as options: --set tni.trv.l1.size='16 KiB'.
std::string settings_text(const sweep::Point& point) {
  std::string out;
  for (const std::string& set : point.sets) {
    const std::size_t value = set.find('=') + 1;
    out += fmt::format("{}--set {}{}", out.empty() ? "" : " ", set.substr(0, value), command_text({set.substr(value)}));
  }
  return out;
}

using Lines = std::vector<std::pair<std::string, std::string>>;

/// Returns the figure of a point, with replicates as "664.5 ± 0.6 %, mean of 5 plays".
std::string figure_text(const Results& results, const Column& figure, std::size_t row) {
  const FigureNoise noise(results, figure, {row});
  const std::string value = shown_cells(noise.means(), {row}).front();
  if (!noise.is_measured()) return value;
  return fmt::format("{} {}, mean of {} plays", value, interval_text(noise, row), noise.replicate_count(row));
}

/// Lists the figures of a point: the metric, and the figures that conditions compare.
Lines figure_lines(const Results& results, const Column& metric, const BestOptions& options, std::size_t row) {
  Lines lines = {{shown_name(metric), figure_text(results, metric, row)}};
  for (const std::string& path : compared_paths(options.where)) {
    const Column column = results.column(path);
    const auto is_this = [&](const auto& line) { return line.first == shown_name(column); };
    const bool is_axis = std::ranges::find(results.axes(), column.name) != results.axes().end();
    if (is_axis || std::ranges::any_of(lines, is_this)) continue;
    lines.emplace_back(shown_name(column), figure_text(results, column, row));
  }
  return lines;
}

/// InputError if draws of the energy tables are requested for a figure without energy.
void check_has_band(const Column& metric, const BestOptions& options) {
  if (!options.band || energy_metric(metric.name)) return;
  throw sim::InputError(fmt::format("--energy band: {} has no joules that draws tell of; allowed: {}",
                                    shown_name(metric), kEnergyMetrics));
}

}  // namespace

std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options) {
  const Column metric = results.column(options.metric);
  check_has_band(metric, options);
  const std::vector<bool> may = rows_meeting(results, options.where);
  std::vector<std::size_t> candidates;
  for (std::size_t row = 0; row < may.size(); ++row) {
    if (may[row] && results.rows()[row].is_done() && amount_of(metric.values[row])) candidates.push_back(row);
  }
  const FigureNoise noise(results, metric, candidates);
  std::optional<std::size_t> best;
  std::size_t equal = 0;
  double figure = 0;
  for (const std::size_t row : candidates) {
    const double value = amount_of(noise.means().values[row])->value;
    if (best && value == figure) ++equal;
    if (best && !(options.most ? value > figure : value < figure)) continue;
    best = row;
    figure = value;
    equal = 0;
  }
  const std::string missing = results.missing_text();
  if (!best) {
    throw sim::InputError(fmt::format("no point has {} as a number{}{}", shown_name(metric),
                                      options.where.empty() ? "" : " and meets --where",
                                      missing.empty() ? "" : "; " + missing));
  }
  if (*best >= points.size() || points[*best].id != results.rows()[*best].id) {
    throw sim::InputError("the sweep has other points than the index; run 'raywatt sweep collect'");
  }
  const std::string config = (results.folder_of(results.rows()[*best]) / "config.yaml").string();
  std::string out = fmt::format("{} {} of {} points that qualify: point {}{}\n\n", options.most ? "most" : "least",
                                shown_name(metric), candidates.size(), results.rows()[*best].n,
                                equal == 0 ? "" : fmt::format(" (and {} more with the same)", equal));
  Lines lines = figure_lines(results, metric, options, *best);
  for (const std::string& axis : results.axes()) {
    const Value value = results.column(axis).values[*best];
    if (!is_absent(value)) lines.emplace_back(sim::printable(axis), sim::printable(exact_text(value)));
  }
  if (!points[*best].sets.empty()) {
    lines.emplace_back("settings", sim::printable(settings_text(points[*best]), 4096));
  }
  lines.emplace_back("id", results.rows()[*best].id);
  lines.emplace_back("configuration", sim::printable(config, 4096));
  lines.emplace_back("run again", sim::printable(rerun_command(points[*best], config), 4096));
  std::size_t widest = 0;
  for (const auto& [name, value] : lines) widest = std::max(widest, name.size());
  for (const auto& [name, value] : lines) out += fmt::format("{:<{}}  {}\n", name, widest, value);
  if (noise.is_noisy() && candidates.size() > 1) {
    const std::vector<std::size_t> ties = find_ties(noise, options.most, candidates, *best);
    out += "\n" + ties_text(results, noise, candidates, *best, ties);
  }
  if (options.band) {
    EnergyBand band(results, may);
    out += "\n" + band.best_text(results, band.price_metric(noise.means(), options.most));
    out += energy_draws_note({&noise});
  }
  out += extrapolated_note(results, candidates);
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

}  // namespace tools::results
