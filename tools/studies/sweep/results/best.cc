#include "tools/studies/sweep/results/best.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/results/cells.h"
#include "tools/studies/sweep/results/condition.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/notes.h"
#include "tools/studies/sweep/results/ties.h"

namespace tools::results {
namespace {

/// The command that runs a point again with its configuration as it was, whatever has become of the files that the
/// sweep began with.
std::string rerun_command(sweep::Point point, const std::string& config) {
  point.config = config;
  point.sets.clear();
  for (std::string* in_config : {&point.scene, &point.camera, &point.frames, &point.resolution}) in_config->clear();
  return command_text(point.options().argv);
}

/// The settings of a point as words for a command line: --set tni.trv.l1.size='16 KiB'.
std::string settings_text(const sweep::Point& point) {
  std::string out;
  for (const std::string& set : point.sets) {
    const std::size_t value = set.find('=') + 1;
    out += fmt::format("{}--set {}{}", out.empty() ? "" : " ", set.substr(0, value), command_text({set.substr(value)}));
  }
  return out;
}

using Lines = std::vector<std::pair<std::string, std::string>>;

/// A figure of a point: that of its play, or "664.5 ± 0.6 %, mean of 5 plays".
std::string figure_text(const Results& results, const Column& figure, std::size_t row) {
  const FigureNoise noise(results, figure, {row});
  const std::string value = shown_cells(noise.means(), {row}).front();
  if (!noise.is_measured()) return value;
  return fmt::format("{} {}, mean of {} plays", value, give_or_take(noise, row), noise.plays(row));
}

/// Figures of a point: the one that was asked for, and those that conditions compare.
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

void check_has_band(const Column& metric, const BestOptions& options) {
  if (!options.band || energy_metric(metric.name)) return;
  throw sim::InputError(fmt::format("--energy band: {} has no joules that draws tell of; allowed: {}",
                                    shown_name(metric), kEnergyMetrics));
}

}  // namespace

std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options) {
  const Column metric = results.column(options.metric);
  check_has_band(metric, options);
  const std::vector<bool> may = meeting(results, options.where);
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
  const std::string missing = results.what_is_missing();
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
    const std::vector<std::size_t> ties = ties_with(noise, options.most, candidates, *best);
    out += "\n" + ties_text(results, noise, candidates, *best, ties);
  }
  if (options.band) {
    EnergyBand band(results, may);
    out += "\n" + band.best_text(results, band.metric(noise.means(), options.most));
    out += draws_note({&noise});
  }
  out += extrapolated_note(results, candidates);
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

}  // namespace tools::results
