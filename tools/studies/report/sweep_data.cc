#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/report/report.h"
#include "tools/studies/report/search_data.h"
#include "tools/studies/sweep/results/best.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/machine_set.h"
#include "tools/studies/sweep/results/sensitivity.h"
#include "tools/studies/sweep/spec/set_metric.h"
#include "tools/studies/sweep/spec/spec.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::pages {
namespace {

namespace fs = std::filesystem;
using results::magnitude_of;
using results::Value;
using sim::Json;

constexpr std::size_t kLongestText = 4000;
const std::vector<std::string> kHeadlines = {"totals.perf.frames_per_joule_gpu", "totals.perf.fps",
                                             "totals.energy_mj.nominal", "totals.power_w.nominal", "totals.cycles"};
const std::vector<std::string> kSetHeadlines = {"geomean(totals.perf.frames_per_joule_gpu)", "geomean(totals.perf.fps)",
                                                "worst(totals.perf.fps)", "worst(totals.power_w.nominal)",
                                                "worst(totals.psnr_db)"};
/// Metrics that the scatter plot of a sweep shows first, in order of preference.
const std::vector<std::string> kStart = {"totals.power_w.nominal", "totals.perf.fps", "totals.cycles",
                                         "totals.energy_mj.nominal"};
const std::vector<std::string> kSetStart = {"worst(totals.power_w.nominal)", "worst(totals.perf.fps)",
                                            "geomean(totals.energy_mj.nominal)"};

/// A metric that the page of a sweep shows. `show`: number format used by the page's script.
struct Metric {
  std::string path, words;
  const char* show = "number";
  const char* unit = "";
  bool more_is_better = false;
};
const std::vector<Metric> kUsualMetrics = {{"totals.perf.fps", "frame rate", "number", "frames/s"},
                                           {"totals.power_w.nominal", "power", "number", "W"},
                                           {"totals.energy_mj.nominal", "energy", "number", "mJ"},
                                           {"totals.perf.frames_per_joule_gpu", "frames per joule"},
                                           {"totals.perf.frames_per_joule_tni", "frames per joule, T&I alone"},
                                           {"totals.cycles", "cycles", "si"},
                                           {"totals.perf.mrays_per_s", "ray rate", "number", "Mrays/s"},
                                           {"totals.perf.nj_per_ray", "energy of a ray", "number", "nJ"},
                                           {"totals.dram_bytes", "DRAM traffic", "si", "B"},
                                           {"totals.utilisation.tni", "T&I busy", "percent"},
                                           {"totals.utilisation.srp", "SRP busy", "percent"},
                                           {"totals.utilisation.dram", "DRAM busy", "percent"},
                                           {"totals.area_mm2", "area", "number", "mm²"},
                                           {"totals.psnr_db", "PSNR", "number", "dB"},
                                           {"totals.worst_psnr_db", "PSNR of the worst frame", "number", "dB"},
                                           {"totals.temporal_psnr_db", "PSNR of the worst change", "number", "dB"},
                                           {"totals.relative.speedup", "speed against reference", "number", "×"},
                                           {"totals.traced_ratio", "samples traced", "percent"}};

/// A metric that a page shows for machines. `per_workload`: also shown for each workload.
struct SetFigure {
  Metric metric;
  bool per_workload = false;
};
const std::vector<SetFigure> kSetFigures = {
    {{"totals.perf.fps", "frame rate", "number", "frames/s"}, true},
    {{"totals.fps_margin", "margin to the target rate", "number", "×"}},
    {{"totals.power_w.nominal", "power", "number", "W"}, true},
    {{"totals.power_at_fps_w.nominal", "power at the target rate", "number", "W"}, true},
    {{"totals.energy_mj.nominal", "energy", "number", "mJ"}},
    {{"totals.perf.frames_per_joule_gpu", "frames per joule"}, true},
    {{"totals.dram_bytes", "DRAM traffic", "si", "B"}},
    {{"totals.psnr_db", "PSNR", "number", "dB"}, true},
    {{"totals.worst_psnr_db", "PSNR of the worst frame", "number", "dB"}},
    {{"totals.area_mm2", "area", "number", "mm²"}}};

/// Reads the task of a search from its folder. Returns nothing for the folder of a sweep.
std::optional<optimise::Task> task_in(const fs::path& folder) {
  try {
    return optimise::read_task(folder / "sweep.yaml");
  } catch (const sim::InputError&) {
    return std::nullopt;
  }
}

std::string question_in(const fs::path& folder) {
  try {
    return sweep::read_spec(folder / "sweep.yaml").question;
  } catch (const sim::InputError&) {
    return {};  // the results can be shown without the task
  }
}

/// Makes the data of the page of a sweep or search from its results.
class Sweep {
 public:
  Sweep(const fs::path& folder, const results::Results& results)
      : folder_(folder),
        results_(results),
        points_(sweep::SweepFolder::open(folder).read_points()),
        task_(task_in(folder)),
        rows_{results.machines().is_set(), {}},
        axes_(rows_.varying_axes(results)) {
    if (points_.size() != results.rows().size() ||
        !std::ranges::equal(points_, results.rows(), {}, &sweep::Point::id, &results::Row::id)) {
      throw sim::InputError(folder.string() + ": has other points than its index; run 'raywatt sweep collect'");
    }
    std::vector<Metric> candidates = rows_.by_machine ? set_metrics() : kUsualMetrics;
    for (const optimise::Goal& goal : goals()) {
      const std::string path = resolve_metric(goal.metric);
      goal_paths_.push_back(path);
      const bool is_known = path.empty() || std::ranges::find(candidates, path, &Metric::path) != candidates.end();
      if (!is_known) candidates.insert(candidates.begin(), {path, metric_name(path)});
    }
    for (const Metric& metric : candidates) add_metric(metric);
    find_eligible();
  }

  Json data_json() const {
    const Metric* const main = main_metric();
    const std::optional<std::size_t> best = main != nullptr ? best_row(*main) : std::nullopt;
    std::vector<const Metric*> shown_metrics;
    if (main != nullptr) shown_metrics.push_back(main);
    add_metrics_at(headlines(), shown_metrics);
    Json headline_fields = Json::array(), best_rows = Json::object(), sensitivities = Json::array(),
         texts = Json::array();
    for (const Metric* const metric : shown_metrics) {
      headline_fields.push_back(metric->path);
      if (const auto row = best_row(*metric)) best_rows[metric->path] = index_of(*row);
      if (Json found = sensitivity_json(*metric); !found.is_null()) sensitivities.push_back(std::move(found));
    }
    for (const optimise::Goal& goal : goals()) texts.push_back(goal.text());
    return {{"name", sim::printable(fs::absolute(folder_ / "x").parent_path().filename().string(), kLongestText)},
            {"question", sim::printable(task_ ? task_->space.question : question_in(folder_), kLongestText)},
            {"goals", std::move(texts)},
            {"noun", noun()},
            {"workloads", workloads_json()},
            {"axes", axes_json()},
            {"metrics", metrics_json()},
            {"points", points_json()},
            {"has_constraints", has_constraints_},
            {"limits", limits_json(best)},
            {"headlines", std::move(headline_fields)},
            {"best", std::move(best_rows)},
            {"ties", best ? ties_text(*main, *best) : ""},
            {"start", start_json()},
            {"sensitivities", std::move(sensitivities)},
            {"notices", notices_json(best)}};
  }

 private:
  /// Returns what a row is: a machine in searches and for several workloads, otherwise a point of the sweep.
  const char* noun() const { return task_ ? "machine" : rows_.noun(); }
  const std::vector<optimise::Goal>& goals() const {
    static const std::vector<optimise::Goal> kNone;
    return task_ ? task_->goals : kNone;
  }
  const std::vector<results::Row>& index_rows() const { return results_.rows(); }
  const std::vector<std::string>& headlines() const { return rows_.by_machine ? kSetHeadlines : kHeadlines; }

  /// Returns the metrics that a page shows for machines: of the machine alone, aggregates, and on each workload.
  std::vector<Metric> set_metrics() const {
    std::vector<Metric> metrics;
    const auto add = [&](const Metric& of, const std::string& path, const std::string& words) {
      metrics.push_back({path, words, of.show, of.unit});
    };
    for (const auto& [metric, per_workload] : kSetFigures) {
      if (sweep::is_metric_of_machine(metric.path)) {
        metrics.push_back(metric);
        continue;
      }
      add(metric, fmt::format("worst({})", metric.path), metric.words + ", worst");
      add(metric, fmt::format("geomean({})", metric.path), metric.words + ", geomean");
      if (!per_workload) continue;
      for (const std::string& workload : results_.machines().workloads) {
        add(metric, path_on(workload, metric.path), fmt::format("{} on {}", metric.words, sim::printable(workload)));
      }
    }
    return metrics;
  }
  static std::string path_on(const std::string& workload, const std::string& path) {
    return fmt::format("on({}, {})", workload, path);
  }
  /// Returns the rows that the page lists: all points, or the first point of each machine.
  std::vector<std::size_t> listed_rows() const {
    std::vector<std::size_t> rows;
    const results::MachineSet& machines = results_.machines();
    for (std::size_t machine = 0; machine < machines.rows.size(); ++machine)
      rows.push_back(machines.first_row(machine));
    return rows;
  }
  /// Returns the index of a row among listed_rows().
  std::size_t index_of(std::size_t row) const { return results_.machines().machine_of[row]; }
  Json indices_of(const std::vector<std::size_t>& rows) const {
    Json indices = Json::array();
    for (const std::size_t row : rows) indices.push_back(index_of(row));
    return indices;
  }

  /// Returns the full report path of a metric; empty if no point has the metric.
  std::string resolve_metric(const std::string& name) const {
    try {
      return results::Objective(results_, name).column.name;
    } catch (const sim::InputError&) {
      return {};
    }
  }
  /// Adds a metric to the page if at least one point has a value of it.
  void add_metric(Metric metric) {
    try {
      const results::Objective objective(results_, metric.path);
      const auto& values = objective.column.values;
      if (std::ranges::none_of(values, [](const Value& value) { return magnitude_of(value).has_value(); })) return;
      metric.path = objective.column.name;
      metric.more_is_better = objective.more_is_better;
    } catch (const sim::InputError&) {
      return;  // no point has this metric
    }
    for (std::size_t g = 0; g < goals().size(); ++g) {
      if (goals()[g].is_objective() && goal_paths_[g] == metric.path)
        metric.more_is_better = goals()[g].kind == optimise::Goal::Kind::kMax;
    }
    values_.push_back(results::column_of_means(results_, metric.path));
    metrics_.push_back(std::move(metric));
  }
  /// Marks the points that may be best or on the Pareto front: those with results that meet all constraints.
  void find_eligible() {
    for (const results::Row& row : index_rows()) done_.push_back(row.is_done());
    eligible_ = rows_.by_machine ? results_.machines().machines_with_all_points(done_) : done_;
    for (std::size_t g = 0; g < goals().size(); ++g) {
      if (goals()[g].is_objective()) continue;
      has_constraints_ = true;
      const Metric* const metric = metric_at(goal_paths_[g]);
      for (std::size_t row = 0; row < eligible_.size(); ++row) {
        const auto value = metric == nullptr ? std::nullopt : value_of(*metric, row);
        eligible_[row] = eligible_[row] && value && goals()[g].is_met(*value);
      }
    }
  }

  const Metric* metric_at(const std::string& path) const {
    const auto found = std::ranges::find(metrics_, path, &Metric::path);
    return found == metrics_.end() ? nullptr : &*found;
  }
  /// Appends the metrics with these report paths to `list`, without duplicates and without metrics that no point has.
  void add_metrics_at(const auto& paths, std::vector<const Metric*>& list) const {
    for (const auto& path : paths) {
      const Metric* const metric = metric_at(path);
      if (metric != nullptr && std::ranges::count(list, metric) == 0) list.push_back(metric);
    }
  }
  std::optional<double> value_of(const Metric& metric, std::size_t row) const {
    const auto amount = magnitude_of(values_[static_cast<std::size_t>(&metric - metrics_.data())].values[row]);
    return amount ? std::optional(amount->value) : std::nullopt;
  }
  /// Returns the main metric of the page: the first objective of a search, or frames per joule.
  const Metric* main_metric() const {
    if (!goal_paths_.empty()) {
      if (const Metric* const first = metric_at(goal_paths_[0])) return first;
    }
    const Metric* const usual = metric_at(headlines()[0]);
    return usual != nullptr || metrics_.empty() ? usual : &metrics_.front();
  }
  /// Returns the row of the eligible point with the best value of a metric. Ties are broken by the goals and headline
  /// metrics, so that the point is on the Pareto front.
  std::optional<std::size_t> best_row(const Metric& metric) const {
    std::vector<const Metric*> order = {&metric};
    add_metrics_at(goal_paths_, order);
    add_metrics_at(headlines(), order);
    std::optional<std::size_t> best;
    std::vector<double> best_scores;
    for (const std::size_t row : candidates_of(metric)) {
      std::vector<double> scores;
      for (const Metric* const each : order) {
        const auto value = value_of(*each, row);
        scores.push_back(!value ? -std::numeric_limits<double>::infinity() : each->more_is_better ? *value : -*value);
      }
      if (best && scores <= best_scores) continue;
      best = row;
      best_scores = std::move(scores);
    }
    return best;
  }
  std::vector<std::size_t> candidates_of(const Metric& metric) const {
    std::vector<std::size_t> out;
    for (std::size_t row = 0; row < eligible_.size(); ++row) {
      if (eligible_[row] && value_of(metric, row)) out.push_back(row);
    }
    return out;
  }
  std::vector<std::size_t> done_rows() const {
    std::vector<std::size_t> out;
    for (std::size_t row = 0; row < done_.size(); ++row) {
      if (done_[row]) out.push_back(row);
    }
    return out;
  }

  Json axes_json() const {
    Json out = Json::array();
    for (const results::Column& axis : axes_) {
      std::vector<Value> values = axis.values;
      std::ranges::stable_sort(values, results::sorts_before);
      Json levels = Json::array();
      for (const Value& value : values) {
        const std::string text = sim::printable(results::exact_text(value));
        if (levels.empty() || levels.back() != text) levels.push_back(text);
      }
      out.push_back({{"field", sim::printable(axis.name)}, {"levels", std::move(levels)}});
    }
    return out;
  }
  Json metrics_json() const {
    Json out = Json::array();
    for (const Metric& metric : metrics_) {
      out.push_back({{"field", metric.path},
                     {"name", metric.words},
                     {"show", metric.show},
                     {"unit", metric.unit},
                     {"more", metric.more_is_better}});
    }
    return out;
  }
  /// Returns the workloads, and for each metric that is shown per workload its fields; null unless machines are shown.
  Json workloads_json() const {
    if (!rows_.by_machine) return {};
    Json names = Json::array(), figures = Json::array();
    for (const std::string& workload : results_.machines().workloads) names.push_back(sim::printable(workload));
    for (const auto& [metric, per_workload] : kSetFigures) {
      Json fields = Json::array();
      for (const std::string& workload : results_.machines().workloads) {
        const Metric* const on = metric_at(path_on(workload, metric.path));
        if (on != nullptr) fields.push_back(on->path);
      }
      if (fields.size() != names.size()) continue;
      figures.push_back({{"name", metric.words}, {"show", metric.show}, {"unit", metric.unit}, {"fields", fields}});
    }
    return {{"names", std::move(names)}, {"figures", std::move(figures)}};
  }
  Json points_json() const {
    const results::Column errors = results_.column("error"), numbers = rows_.numbers(results_);
    const results::Column status = rows_.by_machine ? results::machine_status(results_) : results_.column("status");
    Json out = Json::array();
    for (const std::size_t i : listed_rows()) {
      Json cells = Json::array({std::get<std::int64_t>(numbers.values[i]), results::exact_text(status.values[i])});
      for (const results::Column& axis : axes_) cells.push_back(sim::printable(results::exact_text(axis.values[i])));
      for (const Metric& metric : metrics_) {
        const auto value = value_of(metric, i);
        cells.push_back(value ? Json(*value) : Json());
      }
      cells.push_back(bool{eligible_[i]});
      std::string error, command;
      for (const std::size_t point : rows_.points_of(results_, {i})) {
        const std::string text = results::exact_text(errors.values[point]);
        if (!text.empty()) error += fmt::format("{}{}", error.empty() ? "" : "; ", text);
        command += fmt::format("{}{}", command.empty() ? "" : " && ", command_text(points_[point].run_options().argv));
      }
      cells.push_back(sim::printable(error, kLongestText));
      cells.push_back(sim::printable(command, kLongestText));
      out.push_back(std::move(cells));
    }
    return out;
  }
  /// Returns for each constraint of a search the number of points that meet it, and the best point's value, 95 %
  /// interval and distance to the limit.
  Json limits_json(std::optional<std::size_t> best) const {
    Json out = Json::array();
    const std::vector<std::size_t> done = done_rows();
    for (std::size_t g = 0; g < goals().size(); ++g) {
      const optimise::Goal& goal = goals()[g];
      const Metric* const metric = metric_at(goal_paths_[g]);
      if (goal.is_objective() || metric == nullptr) continue;
      const auto met = std::ranges::count_if(done, [&](std::size_t row) {
        const auto value = value_of(*metric, row);
        return value && goal.is_met(*value);
      });
      Json cells = Json::array({goal.text(), met, nullptr, "", ""});
      if (best) {
        const double value = value_of(*metric, *best).value_or(0);
        const results::MetricNoise noise(results_, results_.column(metric->path), done);
        cells = Json::array({goal.text(), met, value, noise.is_noisy() ? results::interval_text(noise, *best) : "",
                             goal.distance_text(value)});
      }
      out.push_back(std::move(cells));
    }
    return out;
  }
  /// Returns a note on the points that are not significantly worse than the best: "; 3 points tie with it (...)".
  std::string ties_text(const Metric& metric, std::size_t best) const {
    const std::vector<std::size_t> candidates = candidates_of(metric);
    const results::MetricNoise noise(results_, results_.column(metric.path), candidates);
    if (!noise.is_noisy() || candidates.size() < 2) return {};
    const std::size_t ties = results::find_ties(noise, metric.more_is_better, candidates, best).size();
    return fmt::format("; {} with it ({})",
                       ties == 0   ? fmt::format("no {} ties", noun())
                       : ties == 1 ? fmt::format("1 {} ties", noun())
                                   : fmt::format("{} {}s tie", ties, noun()),
                       noise.describe());
  }
  /// Returns the initial scatter plot: two metrics, their Pareto front, and the points within noise of the front. A
  /// search shows its objectives, a sweep shows power and frame rate.
  Json start_json() const {
    std::vector<const Metric*> first;
    for (std::size_t g = 0; g < goals().size(); ++g) {
      if (goals()[g].is_objective()) add_metrics_at(std::vector{goal_paths_[g]}, first);
    }
    add_metrics_at(rows_.by_machine ? kSetStart : kStart, first);
    if (first.empty()) return {};
    if (first.size() == 1) first.push_back(first[0]);
    if (task_) std::swap(first[0], first[1]);
    results::Objective x(results_, first[0]->path), y(results_, first[1]->path);
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < eligible_.size(); ++row) {
      if (eligible_[row] && x.value_of(row) && y.value_of(row)) rows.push_back(row);
    }
    std::vector<std::size_t> front, near;
    if (!rows.empty()) {
      const results::MetricNoise x_noise(results_, x.column, rows), y_noise(results_, y.column, rows);
      x.column = x_noise.means();
      y.column = y_noise.means();
      const results::ParetoFront found = results::find_front(x, y, eligible_);
      front = found.rows;
      near = results::find_near_front(x, y, x_noise, y_noise, found, {});
    }
    return {{"x", first[0]->path}, {"y", first[1]->path}, {"front", indices_of(front)}, {"near", indices_of(near)}};
  }
  /// Returns how much each axis affects a metric; null if the metric does not vary.
  Json sensitivity_json(const Metric& metric) const {
    try {
      const results::Sensitivity found = results::find_sensitivity(results_, metric.path, done_);
      if (!found.varies || found.effects.empty()) return {};
      Json effects = Json::array();
      for (const results::Effect& effect : found.effects) {
        effects.push_back({{"axis", sim::printable(effect.axis)},
                           {"share", effect.share},
                           {"low", effect.low},
                           {"high", effect.high},
                           {"range", effect.range},
                           {"levels", effect.levels.size()}});
      }
      return {{"metric", metric.path},
              {"points", found.points},
              {"is_grid", found.is_grid},
              {"effects", std::move(effects)}};
    } catch (const sim::InputError&) {
      return {};  // no point has this metric
    }
  }
  /// Returns warnings on missing results and on values extrapolated from tables.
  Json notices_json(std::optional<std::size_t> best) const {
    Json out = Json::array();
    if (const std::string missing = results_.missing_text(); !missing.empty()) out.push_back(missing);
    const auto points = best ? rows_.points_of(results_, {*best}) : std::vector<std::size_t>();
    for (const std::size_t point : points) {
      const results::Row& row = index_rows()[point];
      const std::string name =
          rows_.by_machine ? fmt::format("Best machine, point {}", row.n) : fmt::format("Best point, {}", row.n);
      try {
        for (const std::string& line : results::extrapolation_lines(load_report(results_.folder_of(row)).json))
          out.push_back(sim::printable(fmt::format("{}: {}", name, line), kLongestText));
      } catch (const sim::InputError&) {
        out.push_back(fmt::format("{}: its report cannot be read.", name));
      }
    }
    std::string note = results::extrapolated_note(results_, done_rows());
    std::erase(note, '\n');
    if (!note.empty()) out.push_back("There are " + note);
    return out;
  }

  const fs::path folder_;
  const results::Results& results_;
  std::vector<sweep::Point> points_;
  std::optional<optimise::Task> task_;   ///< the task of a search; none for a sweep
  std::vector<std::string> goal_paths_;  ///< report path of each goal's metric; empty if no point has it
  results::RankedRows rows_;             ///< points, or machines of a set of workloads
  std::vector<results::Column> axes_;    ///< axes that have more than one value
  std::vector<Metric> metrics_;          ///< metrics that at least one point has
  std::vector<results::Column> values_;  ///< values of each metric at all points; means of replicates
  std::vector<bool> done_;               ///< for each point: has a result
  std::vector<bool> eligible_;           ///< for each row: the point or machine meets all constraints
  bool has_constraints_ = false;
};

}  // namespace

bool is_sweep(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "sweep.json", ignored);
}

Json sweep_data(const fs::path& folder) {
  results::collect_if_writable(folder, "the page shows what was last collected");
  const results::Results results(folder);
  Json page = Sweep(folder, results).data_json();
  add_search_page_data(folder, page);
  return page;
}

}  // namespace tools::pages
