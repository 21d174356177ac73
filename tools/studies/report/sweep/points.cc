#include <algorithm>
#include <array>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_paths.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/report/sweep/sweep_parts.h"
#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::pages {
namespace {

using results::amount_of;
using results::Value;

constexpr std::size_t kLongestText = 4000;

/// The usual figures, with their words.
const std::vector<Metric>& usual_metrics() {
  static const std::vector<Metric> kUsual = {
      {"totals.perf.fps", "frame rate", Show::kNumber, "frames/s"},
      {"totals.power_w.nominal", "power", Show::kNumber, "W"},
      {"totals.energy_mj.nominal", "energy", Show::kNumber, "mJ"},
      {"totals.perf.frames_per_joule_gpu", "frames per joule", Show::kNumber},
      {"totals.perf.frames_per_joule_tni", "frames per joule, T&I alone", Show::kNumber},
      {"totals.cycles", "cycles", Show::kSi},
      {"totals.perf.mrays_per_s", "ray rate", Show::kNumber, "Mrays/s"},
      {"totals.perf.nj_per_ray", "energy of a ray", Show::kNumber, "nJ"},
      {"totals.dram_bytes", "DRAM traffic", Show::kSi, "B"},
      {"totals.utilisation.tni", "T&I busy", Show::kPercent},
      {"totals.utilisation.srp", "SRP busy", Show::kPercent},
      {"totals.utilisation.dram", "DRAM busy", Show::kPercent},
      {"totals.area_mm2", "area", Show::kNumber, "mm²"},
      {"totals.psnr_db", "PSNR", Show::kNumber, "dB"},
      {"totals.relative.speedup", "speed against reference", Show::kNumber, "×"},
      {"totals.traced_ratio", "samples traced", Show::kPercent}};
  return kUsual;
}

/// Axes first: their values are texts, in the order of their amounts.
Json axes_of(const Sweep& sweep) {
  Json out = Json::array();
  for (std::size_t a = 0; a < sweep.axes.size(); ++a) {
    std::vector<Value> values = sweep.axes[a].values;
    std::ranges::stable_sort(values, results::is_before);
    Json levels = Json::array();
    for (const Value& value : values) {
      const std::string text = sim::printable(results::exact_text(value));
      if (levels.empty() || levels.back() != text) levels.push_back(text);
    }
    out.push_back({{"field", sim::printable(sweep.axes[a].name)}, {"levels", std::move(levels)}});
  }
  return out;
}

Json number_of(const Value& value) {
  const auto amount = amount_of(value);
  return amount ? Json(amount->value) : Json();
}

Dataset points_of(const Sweep& sweep) {
  std::vector<Column> columns = {{"n", "n", Show::kNumber}, {"status", "status"}};
  for (const results::Column& axis : sweep.axes)
    columns.push_back({sim::printable(axis.name), sim::printable(axis.name)});
  for (const Metric& metric : sweep.metrics) columns.push_back({metric.path, metric.words, metric.show, metric.unit});
  const bool has_constraints = sweep.has_constraints();
  const std::vector<bool> eligible = sweep.eligible();
  if (has_constraints) columns.push_back({"constraints", "constraints"});
  columns.push_back({"error", "error"});
  columns.push_back({"command", "command"});
  const results::Column errors = sweep.results.column("error");
  Dataset data(std::move(columns));
  for (std::size_t i = 0; i < sweep.results.rows().size(); ++i) {
    const results::Row& row = sweep.results.rows()[i];
    std::vector<Json> cells = {row.n, std::string(name_of(row.status))};
    for (const results::Column& axis : sweep.axes)
      cells.emplace_back(sim::printable(results::exact_text(axis.values[i])));
    for (const results::Column& values : sweep.values) cells.push_back(number_of(values.values[i]));
    if (has_constraints) cells.emplace_back(!row.is_done() ? "" : eligible[i] ? "met" : "broken");
    cells.emplace_back(sim::printable(results::exact_text(errors.values[i]), kLongestText));
    cells.emplace_back(sim::printable(command_text(sweep.points[i].run_options().argv), kLongestText));
    data.row(std::move(cells));
  }
  return data;
}

/// Two figures to begin with: what a search is about, else power and frame rate.
std::pair<std::string, std::string> first_figures(const Sweep& sweep) {
  std::vector<std::string> asked;
  for (std::size_t g = 0; g < sweep.goal_paths.size(); ++g) {
    const Metric* const metric = sweep.metric_of_goal(g);
    if (metric != nullptr && sweep.task->goals[g].is_objective()) asked.push_back(metric->path);
  }
  for (const char* path : {"totals.power_w.nominal", "totals.perf.fps", "totals.cycles", "totals.energy_mj.nominal"}) {
    if (sweep.metric(path) != nullptr && std::ranges::count(asked, path) == 0) asked.emplace_back(path);
  }
  if (asked.empty()) return {};
  if (asked.size() == 1) asked.push_back(asked[0]);
  return sweep.task ? std::pair{asked[1], asked[0]} : std::pair{asked[0], asked[1]};
}

/// The front of the two figures to begin with, and points that noise keeps near it.
Json front_of(const Sweep& sweep, const std::string& x_path, const std::string& y_path) {
  results::Objective x(sweep.results, x_path), y(sweep.results, y_path);
  std::vector<std::size_t> rows;
  const std::vector<bool> may = sweep.eligible();
  for (std::size_t row = 0; row < may.size(); ++row) {
    if (may[row] && x.value_of(row) && y.value_of(row)) rows.push_back(row);
  }
  Json front = Json::array(), near = Json::array();
  if (!rows.empty()) {
    const results::FigureNoise x_noise(sweep.results, x.column, rows), y_noise(sweep.results, y.column, rows);
    x.column = x_noise.means();
    y.column = y_noise.means();
    const results::ParetoFront found = results::find_front(x, y, may);
    for (const std::size_t row : found.rows) front.push_back(row);
    for (const std::size_t row : results::find_near_front(x, y, x_noise, y_noise, found, {})) near.push_back(row);
  }
  return {{"x", x_path}, {"y", y_path}, {"front", std::move(front)}, {"near", std::move(near)}};
}

}  // namespace

std::vector<bool> Sweep::done() const {
  std::vector<bool> out;
  for (const results::Row& row : results.rows()) out.push_back(row.is_done());
  return out;
}

bool Sweep::has_constraints() const { return task && !std::ranges::all_of(task->goals, &optimise::Goal::is_objective); }

std::vector<bool> Sweep::eligible() const {
  std::vector<bool> out = done();
  if (!has_constraints()) return out;
  for (std::size_t g = 0; g < task->goals.size(); ++g) {
    const optimise::Goal& goal = task->goals[g];
    if (goal.is_objective()) continue;
    const Metric* const figure = metric_of_goal(g);
    for (std::size_t row = 0; row < out.size(); ++row) {
      const auto value = figure == nullptr ? std::nullopt : amount_of(values_of(*figure).values[row]);
      out[row] = out[row] && value && goal.is_met(value->value);
    }
  }
  return out;
}

const Metric* Sweep::metric(const std::string& path) const {
  const auto found = std::ranges::find(metrics, path, &Metric::path);
  return found == metrics.end() ? nullptr : &*found;
}

const results::Column& Sweep::values_of(const Metric& metric) const {
  return values[static_cast<std::size_t>(std::ranges::find(metrics, metric.path, &Metric::path) - metrics.begin())];
}

std::vector<std::string> goal_paths_of(const results::Results& results, const optimise::Task& task) {
  std::vector<std::string> paths;
  for (const optimise::Goal& goal : task.goals) {
    try {
      paths.push_back(results::Objective(results, goal.figure).column.name);
    } catch (const sim::InputError&) {
      paths.emplace_back();  // no point has it
    }
  }
  return paths;
}

std::vector<Metric> metrics_of(const results::Results& results, const std::vector<std::string>& goal_paths) {
  std::vector<Metric> wanted = usual_metrics();
  for (const std::string& path : goal_paths) {
    const bool is_known = path.empty() || std::ranges::find(wanted, path, &Metric::path) != wanted.end();
    if (!is_known) wanted.insert(wanted.begin(), {path, metric_name(path)});
  }
  std::vector<Metric> found;
  for (Metric& metric : wanted) {
    try {
      const results::Objective objective(results, metric.path);
      const auto& values = objective.column.values;
      if (std::ranges::none_of(values, [](const Value& value) { return amount_of(value).has_value(); })) continue;
      metric.path = objective.column.name;
      metric.more = objective.most;
      found.push_back(std::move(metric));
    } catch (const sim::InputError&) {
      continue;  // no point has it
    }
  }
  return found;
}

void add_points(const Sweep& sweep, View& view) {
  view.data("points", points_of(sweep));
  Json metrics = Json::array();
  for (const Metric& metric : sweep.metrics) {
    metrics.push_back({{"field", metric.path}, {"name", metric.words}, {"unit", metric.unit}, {"more", metric.more}});
  }
  Json shared = {{"data", "points"}, {"axes", axes_of(sweep)}, {"metrics", metrics}};
  Section front("front", "Points and their front",
                fmt::format("A point is on the front if no other {}is as good in both figures and better in one. A "
                            "click on a point, or on its row below, shows the command that runs it again.",
                            sweep.has_constraints() ? "that meets the constraints " : ""));
  const auto [x, y] = first_figures(sweep);
  if (!x.empty()) {
    Json more = shared;
    more["start"] = front_of(sweep, x, y);
    more["about"] = "All points by two figures, with those on the front";
    front.block("scatter", "scatter", "All points", std::move(more));
  }
  front.block("points", "points", "Points", shared);
  view.add(front);
  if (!x.empty() && sweep.axes.size() > 1) {
    Section parallel(
        "parallel", "Parallel axes",
        "A line is a point, from axis to axis and to its figures. The filter of the table above leaves its "
        "lines here, too.");
    Json more = shared;
    more["start"] = {{"x", x}, {"y", y}};
    more["about"] = "Each point as a line over its axes and figures";
    parallel.block("parallel", "parallel-axes", "All points over axes and figures", std::move(more));
    view.add(parallel);
  }
}

}  // namespace tools::pages
