#include "tools/studies/sweep/results/best.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/results/energy_band.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/results/sensitivity.h"
#include "tools/studies/sweep/spec/set_metric.h"

namespace tools::results {
namespace {

constexpr std::size_t kShownTies = 20;
constexpr std::size_t kLongestCommand = 4096;
constexpr double kLittle = 0.05;  // an axis that explains a smaller share of the variance matters little

/// Returns a table of the best point and the points that tie with it (`rows`), with the axes in which they differ.
std::string tie_table(const Results& results, const RankedRows& ranked, const MetricNoise& noise,
                      const std::vector<std::size_t>& rows) {
  std::vector<Column> columns;
  std::vector<std::string> header = {ranked.noun()};
  for (const Column& axis : ranked.varying_axes(results)) {
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
    std::vector<std::string> line = {std::to_string(ranked.number_of(results, listed[i]))};
    for (const std::vector<std::string>& column : cells) line.push_back(column[i]);
    line.push_back(interval_text(noise, listed[i]));
    table.add_row(std::move(line));
  }
  return table.text() + (rows.size() > kShownTies ? fmt::format("and {} more\n", rows.size() - kShownTies) : "");
}

/// Returns a table of the axes. Each has its values among the points that tie with the best, and a verdict:
/// 1. All values of the axis tie: the axis does not matter if it surely explains less than 5 % of the variance;
///    otherwise noise hides its best value.
/// 2. Not all values tie: the axis matters, or matters little if it explains less than 5 % of the variance.
std::string axis_table(const Results& results, const RankedRows& ranked, const MetricNoise& noise,
                       const std::vector<std::size_t>& candidates, const std::vector<std::size_t>& ties) {
  std::vector<bool> selected(results.rows().size());
  for (const std::size_t row : ranked.points_of(results, candidates)) selected[row] = true;
  sim::Table table({"axis", "values that tie", "of", "share of variance", "95 %"});
  std::vector<std::string> matter, little, do_not, hidden;
  const Sensitivity sensitivity = find_sensitivity(results, noise.means().name, selected);
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
  if (!sensitivity.is_grid) out += fmt::format("the {}s are {}\n", ranked.noun(), kNoGrid);
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

/// Describes the points that tie with the best one: the axes in which they differ, and for each axis its values and the
/// share of the variance over all candidates that it explains.
std::string ties_text(const Results& results, const RankedRows& ranked, const MetricNoise& noise,
                      const std::vector<std::size_t>& candidates, std::size_t first,
                      const std::vector<std::size_t>& ties) {
  std::vector<std::size_t> rows = {first};
  rows.insert(rows.end(), ties.begin(), ties.end());
  std::string out;
  if (ties.empty()) {
    out = fmt::format("no other {0} ties with it (95 %, all {0}s together)", ranked.noun());
  } else {
    out = fmt::format("{0} {1}{2} with it (95 %, all {1}s together)", ties.size(), ranked.noun(),
                      ties.size() == 1 ? " ties" : "s tie");
  }
  out += fmt::format("; {}\n", noise.describe());
  if (!ties.empty()) out += "\n" + tie_table(results, ranked, noise, rows);
  return out + axis_table(results, ranked, noise, candidates, rows);
}

}  // namespace

std::vector<std::size_t> find_ties(const MetricNoise& noise, bool more_is_better,
                                   const std::vector<std::size_t>& candidates, std::size_t first) {
  std::vector<std::size_t> others, ties;
  std::vector<double> p_values;
  for (const std::size_t row : candidates) {
    if (row == first) continue;
    others.push_back(row);
    p_values.push_back(noise.p_value_better(first, row, more_is_better));
  }
  const std::vector<bool> worse = reject_hypotheses(p_values, kError);
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.push_back(others[i]);
  }
  const auto number = [&](std::size_t row) { return magnitude_of(noise.means().values[row])->value; };
  std::ranges::stable_sort(ties, [&](std::size_t a, std::size_t b) {
    return more_is_better ? number(a) > number(b) : number(a) < number(b);
  });
  return ties;
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

/// Returns the value of a metric at a point as text: "664.5", or with replicates "664.5 ± 0.6 %, mean of 5 plays".
std::string figure_text(const Results& results, const Column& figure, std::size_t row) {
  const MetricNoise noise(results, figure, {row});
  const std::string value = shown_cells(noise.means(), {row}).front();
  if (!noise.is_measured()) return value;
  return fmt::format("{} {}, mean of {} plays", value, interval_text(noise, row), noise.replicate_count(row));
}

/// Returns name and value of the ranked metric, and of each metric that the conditions compare, at one point.
Lines figure_lines(const Results& results, const RankedRows& ranked, const Column& metric, const BestOptions& options,
                   std::size_t row) {
  Lines lines = {{shown_name(metric), figure_text(results, metric, row)}};
  for (const std::string& path : compared_paths(options.where)) {
    const Column column = results.column(path, options.more_is_better);
    const auto is_this = [&](const auto& line) { return line.first == shown_name(column); };
    const bool is_axis = std::ranges::find(results.axes(), column.name) != results.axes().end();
    const bool is_per_workload =
        ranked.by_machine && !column.fold && !sweep::is_metric_of_machine(column.name);  // shown in workload_table()
    if (is_axis || is_per_workload || std::ranges::any_of(lines, is_this)) continue;
    lines.emplace_back(shown_name(column), figure_text(results, column, row));
  }
  return lines;
}

/// Returns a table of a machine's metrics on each workload: the ranked metric and those that conditions compare.
std::string workload_table(const Results& results, const Column& metric, const BestOptions& options, std::size_t row) {
  const MachineSet& machines = results.machines();
  std::vector<Column> columns;
  const auto add = [&](const Column& column) {
    Column points = column.fold ? column.fold->points : column;
    const bool is_known = std::ranges::find(columns, points.name, &Column::name) != columns.end();
    const bool is_axis = std::ranges::find(results.axes(), points.name) != results.axes().end();
    if (!is_known && !is_axis && !sweep::is_metric_of_machine(points.name)) columns.push_back(std::move(points));
  };
  add(metric);
  for (const std::string& path : compared_paths(options.where)) add(results.column(path, options.more_is_better));
  std::vector<std::string> header = {"workload", "point"};
  for (const Column& column : columns) header.push_back(shown_name(column));
  sim::Table table(header);
  for (std::size_t w = 0; w < machines.workloads.size(); ++w) {
    const std::optional<std::size_t> point = machines.rows[machines.machine_of[row]][w];
    if (!point) continue;
    std::vector<std::string> line = {sim::printable(machines.workloads[w]), std::to_string(results.rows()[*point].n)};
    for (const Column& column : columns) {
      line.push_back(is_absent(column.values[*point]) ? "-" : figure_text(results, column, *point));
    }
    table.add_row(std::move(line));
  }
  return table.text();
}

/// Returns lines that describe a machine or a point: axes, settings, id, configuration and commands that run it again.
Lines origin_lines(const Results& results, std::span<const sweep::Point> points, const RankedRows& ranked,
                   std::size_t row) {
  Lines lines;
  const MachineSet& machines = results.machines();
  for (const std::string& axis : results.axes()) {
    if (ranked.by_machine && !machines.is_axis(axis)) continue;
    const Value value = results.column(axis).values[row];
    if (!is_absent(value)) lines.emplace_back(sim::printable(axis), sim::printable(exact_text(value)));
  }
  if (!points[row].sets.empty()) {
    lines.emplace_back("settings", sim::printable(settings_text(points[row]), kLongestCommand));
  }
  const auto config_of = [&](std::size_t point) {
    return (results.folder_of(results.rows()[point]) / "config.yaml").string();
  };
  if (!ranked.by_machine) {
    lines.emplace_back("id", results.rows()[row].id);
    lines.emplace_back("configuration", sim::printable(config_of(row), kLongestCommand));
    lines.emplace_back("run again", sim::printable(rerun_command(points[row], config_of(row)), kLongestCommand));
    return lines;
  }
  for (std::size_t w = 0; w < machines.workloads.size(); ++w) {
    const std::optional<std::size_t> point = machines.rows[machines.machine_of[row]][w];
    if (!point) continue;
    lines.emplace_back("run " + sim::printable(machines.workloads[w]),
                       sim::printable(rerun_command(points[*point], config_of(*point)), kLongestCommand));
  }
  return lines;
}

/// Throws InputError if random draws of the energy tables are requested for a metric without energy.
void check_metric_has_energy(const Column& metric, const BestOptions& options) {
  if (!options.band || energy_metric(report_path(metric))) return;
  throw sim::InputError(fmt::format("--energy band: {} does not depend on the energy tables; allowed: {}",
                                    shown_name(metric), kEnergyMetrics));
}

}  // namespace

std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options) {
  const Column metric = results.column(options.metric, options.more_is_better);
  check_metric_has_energy(metric, options);
  const RankedRows ranked = select_ranked(results, std::array{&metric}, options.where);
  std::vector<std::size_t> candidates;
  for (std::size_t row = 0; row < ranked.selected.size(); ++row) {
    const bool has_result = metric.fold || results.rows()[row].is_done();
    if (ranked.selected[row] && has_result && magnitude_of(metric.values[row])) candidates.push_back(row);
  }
  const MetricNoise noise(results, metric, candidates);
  std::optional<std::size_t> best;
  std::size_t equal = 0;
  double figure = 0;
  for (const std::size_t row : candidates) {
    const double value = magnitude_of(noise.means().values[row])->value;
    if (best && value == figure) ++equal;
    if (best && !(options.more_is_better ? value > figure : value < figure)) continue;
    best = row;
    figure = value;
    equal = 0;
  }
  const std::string missing = results.missing_text();
  if (!best) {
    throw sim::InputError(fmt::format("no {} has {} as a number{}{}", ranked.noun(), shown_name(metric),
                                      options.where.empty() ? "" : " and meets --where",
                                      missing.empty() ? "" : "; " + missing));
  }
  if (*best >= points.size() || points[*best].id != results.rows()[*best].id) {
    throw sim::InputError("the sweep has other points than the index; run 'raywatt sweep collect'");
  }
  std::string out = fmt::format(
      "{} {} of {} {}s{}: {} {}{}\n\n", options.more_is_better ? "most" : "least", shown_name(metric),
      candidates.size(), ranked.noun(), options.where.empty() ? "" : " that meet --where", ranked.noun(),
      ranked.number_of(results, *best), equal == 0 ? "" : fmt::format(" (and {} more with the same value)", equal));
  Lines lines = figure_lines(results, ranked, metric, options, *best);
  const Lines origin = origin_lines(results, points, ranked, *best);
  lines.insert(lines.end(), origin.begin(), origin.end());
  std::size_t widest = 0;
  for (const auto& [name, value] : lines) widest = std::max(widest, name.size());
  for (const auto& [name, value] : lines) out += fmt::format("{:<{}}  {}\n", name, widest, value);
  if (ranked.by_machine) out += "\n" + workload_table(results, metric, options, *best);
  if (noise.is_noisy() && candidates.size() > 1) {
    const std::vector<std::size_t> ties = find_ties(noise, options.more_is_better, candidates, *best);
    out += "\n" + ties_text(results, ranked, noise, candidates, *best, ties);
  }
  if (options.band) {
    EnergyBand band(results, ranked.points_of(results, candidates));
    out +=
        "\n" + band.best_text(results, band.price_metric(results, noise.means(), options.more_is_better, candidates));
    out += energy_draws_note({&noise});
  }
  out += extrapolated_note(results, ranked.points_of(results, candidates));
  return missing.empty() ? out : out + "\n" + missing + "\n";
}

namespace {

constexpr std::size_t kHeight = 20, kLeastWidth = 40, kMostWidth = 160;

/// Range of the values of an objective.
struct ValueRange {
  double low = 0, high = 0;
  std::string low_text, high_text;

  ValueRange(const Objective& objective, const std::vector<std::size_t>& rows) {
    const auto by_value = [&](std::size_t a, std::size_t b) { return *objective.value_of(a) < *objective.value_of(b); };
    const auto [least, most] = std::ranges::minmax_element(rows, by_value);
    low = *objective.value_of(*least);
    high = *objective.value_of(*most);
    low_text = end_text(objective, *least);
    high_text = end_text(objective, *most);
  }
  static std::string end_text(const Objective& objective, std::size_t row) {
    const Value& value = objective.column.values[row];
    return std::holds_alternative<std::string>(value) ? std::get<std::string>(value)
                                                      : number_text(*objective.value_of(row));
  }
  std::size_t cell_of(double value, std::size_t cells) const {
    if (high == low) return cells / 2;
    return static_cast<std::size_t>(std::lround((value - low) / (high - low) * static_cast<double>(cells - 1)));
  }
};

/// Draws the Pareto front as a text plot of `width` columns. `noun`: "point" or "machine".
std::string pareto_plot(const Objective& x, const Objective& y, const ParetoFront& front, std::string_view noun,
                        std::size_t width) {
  const std::vector<std::size_t> all = front.all_rows();
  const ValueRange xs(x, all), ys(y, all);
  const std::size_t margin = std::max(xs.low_text.size() / 2, std::max(ys.low_text.size(), ys.high_text.size()));
  const std::size_t columns = std::clamp(width, kLeastWidth, kMostWidth) - margin - 3;
  std::vector<std::string> lines(kHeight, std::string(columns, ' '));
  const auto cell = [&](std::size_t row) -> char& {
    return lines[kHeight - 1 - ys.cell_of(*y.value_of(row), kHeight)][xs.cell_of(*x.value_of(row), columns)];
  };
  for (const std::size_t row : front.other) cell(row) = '.';
  for (const std::size_t row : front.near) cell(row) = '~';
  for (std::size_t i = front.rows.size(); i-- > 0;) cell(front.rows[i]) = front.mark_of(i);

  std::string out = fmt::format("{}\n", y.describe());
  for (std::size_t line = 0; line < kHeight; ++line) {
    const std::string& label = line == 0 ? ys.high_text : line == kHeight - 1 ? ys.low_text : std::string();
    out += fmt::format("{:>{}} |{}", label, margin, lines[line]);
    out.erase(out.find_last_not_of(' ') + 1);
    out += '\n';
  }
  const std::size_t between = columns + 1 - std::min(columns, xs.low_text.size() + xs.high_text.size());
  out += fmt::format("{:>{}} +{:->{}}\n", "", margin, "", columns);
  out += fmt::format("{:>{}}  {}{:>{}}{}\n", "", margin, xs.low_text, "", between - 1, xs.high_text);
  const std::string title = x.describe();
  out += fmt::format("{:>{}}\n", title, std::max(title.size(), margin + 2 + columns));
  out += fmt::format("{} of {} {}s are on the front: {}; dots are the others\n", front.rows.size(), all.size(), noun,
                     front.mark_of(0) == '#' ? "#" : "letters, as in the table");
  if (std::ranges::find(front.sure, false) != front.sure.end()) {
    out += fmt::format("a letter with ~: because of noise, another {} may be as good in both metrics\n", noun);
  }
  if (!front.near.empty()) {
    out += fmt::format("{} more may be on the front, marked ~: no {} beats them by more than the noise\n",
                       front.near.size(), noun);
  }
  return out;
}

std::string path_of(std::string_view text) {
  return std::string(text.starts_with("min:") || text.starts_with("max:") ? text.substr(4) : text);
}

/// Returns true for "max:PATH", false for "min:PATH", and nothing for a bare path.
std::optional<bool> explicit_direction(std::string_view text) {
  const bool is_max = text.starts_with("max:");
  return is_max || text.starts_with("min:") ? std::optional(is_max) : std::nullopt;
}

/// Returns a column with the mark of each point: a letter on the Pareto front, a letter and "~" where noise makes that
/// uncertain, "~" within noise of the front.
Column marks_of(const ParetoFront& front, std::size_t rows, bool csv) {
  Column marks{"", std::vector<Value>(rows)};
  for (std::size_t i = 0; i < front.rows.size(); ++i) {
    marks.values[front.rows[i]] = std::string(1, front.mark_of(i)) + (csv || front.sure[i] ? "" : "~");
  }
  for (const std::size_t row : front.near) marks.values[row] = std::string("~");
  return marks;
}

/// The values of two metrics at the same points, under random draws of the energy tables.
struct DrawnPair {
  BandedMetric x, y;
  std::vector<std::size_t> at;  ///< for each row of the results, its index in `x` and in `y`

  /// Returns the share of the random draws in which row `better` dominates row `worse`.
  double share_dominating(std::size_t better, std::size_t worse) const {
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

DrawnPair price_both(const Results& results, const RankedRows& ranked, const Objective& x, const Objective& y,
                     const ParetoFront& front) {
  if (!energy_metric(report_path(x.column)) && !energy_metric(report_path(y.column))) {
    throw sim::InputError(fmt::format("--energy band: neither {} nor {} depends on the energy tables; allowed: {}",
                                      shown_name(x.column), shown_name(y.column), kEnergyMetrics));
  }
  std::vector<std::size_t> rows = front.all_rows();
  std::ranges::sort(rows);
  EnergyBand band(results, ranked.points_of(results, rows));
  DrawnPair out{band.price_metric(results, x.column, x.more_is_better, rows),
                band.price_metric(results, y.column, y.more_is_better, rows),
                std::vector<std::size_t>(results.rows().size())};
  for (std::size_t i = 0; i < out.x.rows.size(); ++i) out.at[out.x.rows[i]] = i;
  return out;
}

/// Returns a column with the share of random energy tables under which each row is on the Pareto front: "86.5 %".
Column shares_of(const DrawnPair& draws, std::size_t rows, bool csv) {
  Column shares{"on the front in", std::vector<Value>(rows)};
  const std::vector<double> found = EnergyBand::shares_on_front(draws.x, draws.y);
  for (std::size_t i = 0; i < found.size(); ++i) {
    shares.values[draws.x.rows[i]] = csv ? Value(found[i]) : Value(fmt::format("{:.1f} %", 100 * found[i]));
  }
  return shares;
}

/// Adds, for each metric with energy, a column of ratios to the best row under low, nominal and high energy tables.
void add_ratios(const DrawnPair& draws, std::size_t rows, std::vector<Column>& columns) {
  for (const BandedMetric* metric : {&draws.x, &draws.y}) {
    if (!energy_metric(metric->path)) continue;
    Column ratios{fmt::format("{} over the best, low / nominal / high tables", metric->name), std::vector<Value>(rows)};
    const std::size_t best = metric->rank_points().front();
    for (std::size_t i = 0; i < metric->rows.size(); ++i) {
      ratios.values[metric->rows[i]] = metric->ratio_text(i, best);
    }
    columns.push_back(std::move(ratios));
  }
}

/// Returns a line on the noise of an objective; empty if it has none.
std::string noise_line(const Objective& objective, const MetricNoise& noise) {
  return noise.is_noisy() ? fmt::format("{}: {}\n", shown_name(objective.column), noise.describe()) : std::string();
}

/// Returns for each row of the Pareto front whether it is significantly better than every other row in at least one
/// metric. All comparisons of a row together have an error of 5 %.
std::vector<bool> surely_on_front(const Objective& x, const Objective& y, const MetricNoise& x_noise,
                                  const MetricNoise& y_noise, const ParetoFront& front) {
  const std::vector<std::size_t> all = front.all_rows();
  const double level = kError / (2 * static_cast<double>(all.size()));
  std::vector<bool> sure;
  for (const std::size_t row : front.rows) {
    sure.push_back(std::ranges::all_of(all, [&](std::size_t other) {
      const bool is_equal = *x.value_of(row) == *x.value_of(other) && *y.value_of(row) == *y.value_of(other);
      return is_equal || x_noise.p_value_better(row, other, x.more_is_better) <= level ||
             y_noise.p_value_better(row, other, y.more_is_better) <= level;
    }));
  }
  return sure;
}

}  // namespace

Objective::Objective(const Results& results, const std::string& text)
    : column(results.column(path_of(text), explicit_direction(text))),
      more_is_better(explicit_direction(text).value_or(sweep::is_larger_better(report_path(column)).value_or(false))) {}

std::optional<double> Objective::value_of(std::size_t row) const {
  const std::optional<sweep::Magnitude> number = magnitude_of(column.values[row]);
  return number ? std::optional(number->value) : std::nullopt;
}

std::string Objective::describe() const {
  return fmt::format("{} ({} is better)", shown_name(column), more_is_better ? "more" : "less");
}

std::vector<std::size_t> ParetoFront::all_rows() const {
  std::vector<std::size_t> rows_of_both = rows;
  rows_of_both.insert(rows_of_both.end(), other.begin(), other.end());
  return rows_of_both;
}

char ParetoFront::mark_of(std::size_t i) const {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  return rows.size() <= kLetters.size() ? kLetters[i] : '#';
}

ParetoFront find_front(const Objective& x, const Objective& y, const std::vector<bool>& selected) {
  struct Point {
    std::size_t row;
    double x, y;
  };
  std::vector<Point> points;
  for (std::size_t row = 0; row < selected.size(); ++row) {
    const auto at_x = x.value_of(row), at_y = y.value_of(row);
    if (selected[row] && at_x && at_y) points.push_back({row, *at_x, *at_y});
  }
  std::ranges::stable_sort(points, [&](const Point& a, const Point& b) {
    return a.x != b.x ? x.is_better(a.x, b.x) : y.is_better(a.y, b.y);
  });
  ParetoFront front;
  const Point* last = nullptr;  // the point with the best y so far
  for (const Point& point : points) {
    const bool is_equal = last != nullptr && point.x == last->x && point.y == last->y;
    const bool is_on_it = last == nullptr || is_equal || y.is_better(point.y, last->y);
    (is_on_it ? front.rows : front.other).push_back(point.row);
    if (is_on_it) last = &point;
  }
  return front;
}

std::vector<std::size_t> find_near_front(const Objective& x, const Objective& y, const MetricNoise& x_noise,
                                         const MetricNoise& y_noise, const ParetoFront& front,
                                         const std::function<bool(std::size_t better, std::size_t worse)>& sure) {
  const std::vector<std::size_t> all = front.all_rows();
  const double level = kError / static_cast<double>(all.size());
  const auto is_as_good = [&](const Objective& o, const MetricNoise& noise, std::size_t better, std::size_t worse) {
    return noise.p_value_better(better, worse, o.more_is_better) <= level ||
           (!noise.is_noisy() && *o.value_of(better) == *o.value_of(worse));
  };
  const auto beats = [&](std::size_t better, std::size_t worse) {
    if (*x.value_of(better) == *x.value_of(worse) && *y.value_of(better) == *y.value_of(worse)) return false;
    return is_as_good(x, x_noise, better, worse) && is_as_good(y, y_noise, better, worse) &&
           (!sure || sure(better, worse));
  };
  std::vector<std::size_t> near;
  for (const std::size_t row : front.other) {
    if (std::ranges::none_of(all, [&](std::size_t other) { return beats(other, row); })) near.push_back(row);
  }
  return near;
}

std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width) {
  Objective x(results, options.x), y(results, options.y);
  const RankedRows ranked = select_ranked(results, std::array{&x.column, &y.column}, options.where);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < ranked.selected.size(); ++row) {
    if (ranked.selected[row] && x.value_of(row) && y.value_of(row)) rows.push_back(row);
  }
  const MetricNoise x_noise(results, x.column, rows), y_noise(results, y.column, rows);
  x.column = x_noise.means();
  y.column = y_noise.means();
  ParetoFront front = find_front(x, y, ranked.selected);
  if (front.rows.empty()) {
    const std::string missing = results.missing_text();
    throw sim::InputError(fmt::format("no {} has both {} and {}{}{}", ranked.noun(), shown_name(x.column),
                                      shown_name(y.column), options.where.empty() ? "" : " and meets --where",
                                      missing.empty() ? "" : "; " + missing));
  }
  std::optional<DrawnPair> draws;
  std::function<bool(std::size_t, std::size_t)> sure;
  if (options.band) {
    draws = price_both(results, ranked, x, y, front);
    sure = [&](std::size_t better, std::size_t worse) { return draws->share_dominating(better, worse) >= 1 - kError; };
  }
  front.near = find_near_front(x, y, x_noise, y_noise, front, sure);
  front.sure = surely_on_front(x, y, x_noise, y_noise, front);
  std::vector<Column> columns = {marks_of(front, results.rows().size(), options.csv), ranked.numbers(results)};
  if (options.csv) {
    columns.front().name = "front";
    if (!ranked.by_machine) columns.push_back(results.column("id"));
  }
  const auto is_objective = [&](const Column& c) { return c.name == x.column.name || c.name == y.column.name; };
  for (Column& column : ranked.varying_axes(results)) {
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
  std::string out =
      pareto_plot(x, y, front, ranked.noun(), width) + noise_line(x, x_noise) + noise_line(y, y_noise) + "\n" + table;
  if (draws) out += energy_draws_note({&x_noise, &y_noise});
  return out + extrapolated_note(results, ranked.points_of(results, rows));
}

}  // namespace tools::results
