#include "tools/studies/compare/compare_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/noise/noise.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/spec/set_metric.h"

namespace tools {
namespace {

namespace fs = std::filesystem;
using sweep::SetMetric;

/// Identifies what a run renders: scene, resolution, frames and view, in this order.
using WorkloadKey = std::array<std::string, 4>;

WorkloadKey workload_key(const ReportFile& report) {
  const FlatConfig config = report.json.contains("config") ? flat_config(report.json["config"]) : FlatConfig{};
  const auto value = [&](const char* key) {
    const auto found = config.find(key);
    return found == config.end() ? std::string() : found->second;
  };
  return {report.text("scene", "name"),
          fmt::format("{}x{}", report.number("resolution[0]"), report.number("resolution[1]")),
          fmt::format("frames {} to {} at {}/s", value("scene.first_frame"), value("scene.last_frame"),
                      value("scene.frame_rate")),
          fmt::format("camera '{}', view {} from {} to {}", value("scene.camera"), value("scene.view.source"),
                      value("scene.view.position"), value("scene.view.target"))};
}

std::vector<WorkloadKey> workload_keys(const RunSet& set) {
  std::vector<WorkloadKey> keys;
  for (const ReportFile& run : set.runs) keys.push_back(workload_key(run));
  return keys;
}

/// Names each workload by the first parts of its key (scene, resolution, ...), as few as distinguish all workloads. If
/// two keys are equal, names have all parts.
std::vector<std::string> name_workloads(const std::vector<WorkloadKey>& keys) {
  std::vector<std::string> names(keys.size());
  for (std::size_t parts = 1; parts <= WorkloadKey().size(); ++parts) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      names[i] =
          fmt::format("{}", fmt::join(keys[i].begin(), keys[i].begin() + static_cast<std::ptrdiff_t>(parts), " "));
    }
    if (std::set<std::string>(names.begin(), names.end()).size() == names.size()) break;
  }
  return names;
}

std::string listed_workloads(const std::vector<WorkloadKey>& keys) {
  std::vector<std::string> names = name_workloads(keys);
  return sim::printable(fmt::format("{}", fmt::join(names, ", ")), 1000);
}

/// Returns, for each run of set `a`, the run of set `b` on the same workload. Throws InputError if the workloads
/// differ.
std::vector<const ReportFile*> match_runs(const RunSet& a, const RunSet& b) {
  const std::vector<WorkloadKey> of_a = workload_keys(a), of_b = workload_keys(b);
  for (const auto& [set, keys] : {std::pair{&a, &of_a}, {&b, &of_b}}) {
    for (std::size_t i = 0; i < keys->size(); ++i) {
      if (std::ranges::count(*keys, (*keys)[i]) == 1) continue;
      throw sim::InputError(fmt::format("{}: has two runs of {}; allowed: one run per workload", set->name,
                                        sim::printable(fmt::format("{}", fmt::join((*keys)[i], " ")), 1000)));
    }
  }
  std::vector<const ReportFile*> matched;
  for (const WorkloadKey& key : of_a) {
    const auto found = std::ranges::find(of_b, key);
    if (found == of_b.end() || of_a.size() != of_b.size()) {
      throw sim::InputError(
          fmt::format("{} has runs of {}; {} of {}; allowed: sets of the same workloads, with equal resolution, frames "
                      "and view",
                      a.name, listed_workloads(of_a), b.name, listed_workloads(of_b)));
    }
    matched.push_back(&b.runs[static_cast<std::size_t>(found - of_b.begin())]);
  }
  return matched;
}

/// Runs of two sets, matched by workload.
struct MatchedRuns {
  std::vector<std::string> workloads;
  std::vector<const ReportFile*> a, b;
};

/// Evaluates a metric in both sets; its path is a full report path. Values are absent if it has none.
SetRow evaluate_row(std::string name, const SetMetric& metric, const MatchedRuns& matched) {
  const bool larger = sweep::is_larger_better(metric.path).value_or(true);
  const auto evaluate = [&](const std::vector<const ReportFile*>& runs) {
    std::vector<sweep::WorkloadValue> values;
    for (std::size_t w = 0; w < runs.size(); ++w) {
      values.push_back({matched.workloads[w], {}});
      if (runs[w]->has(metric.path)) values.back().seen = results::read_noisy_metric(*runs[w], metric.path);
    }
    return sweep::evaluate_set_metric(metric, values, larger);
  };
  const std::optional<MeasuredMetric> of_a = evaluate(matched.a), of_b = evaluate(matched.b);
  SetRow row{std::move(name), {}, {}};
  if (of_a) row.a = of_a->value;
  if (of_b) row.b = of_b->value;
  const bool has_noise = is_totals_path(metric.path) && is_noisy(metric_name(metric.path));
  if (!has_noise || !of_a || !of_b || of_a->value == 0 || of_b->value == 0) return row;
  const MeanDifference d = difference_of(*of_a, *of_b);
  row.noise = NoisyDifference{d.value / of_a->value, d.half_width() / std::abs(of_a->value), of_a->draws && of_b->draws,
                              std::abs(d.value) > d.half_width()};
  return row;
}

/// Evaluates a metric that the user named. One that is also a main metric has its name. Throws InputError for an
/// unknown path or workload.
SetRows requested_rows(const std::string& text, const std::vector<std::string>& paths, const MatchedRuns& matched,
                       const std::vector<SetRows>& main_metrics) {
  SetMetric metric = sweep::parse_set_metric(text);
  sweep::check_workload(metric, matched.workloads);
  metric.path = resolve_report_path(metric.path, paths);
  const std::string name = metric_name(metric.path);
  const auto known = std::ranges::find(main_metrics, name, &SetRows::label);
  SetRows rows{known == main_metrics.end() ? name : known->name, name, {}};
  if (sweep::is_metric_of_machine(metric.path)) {
    rows.rows.push_back(evaluate_row("all", {SetMetric::Kind::kOn, metric.path, matched.workloads.front()}, matched));
  } else if (metric.kind == SetMetric::Kind::kEach) {
    for (const std::string& workload : matched.workloads)
      rows.rows.push_back(evaluate_row(workload, {SetMetric::Kind::kOn, metric.path, workload}, matched));
  } else {
    const std::string function = metric.text().substr(0, metric.text().find('('));
    const bool is_one = metric.kind == SetMetric::Kind::kOn;
    rows.rows.push_back(evaluate_row(is_one ? metric.workload : function, metric, matched));
  }
  return rows;
}

/// Returns the paths of all numbers that a run of the sets has.
std::vector<std::string> all_paths(const RunSet& a, const RunSet& b) {
  std::set<std::string> paths;
  for (const RunSet* set : {&a, &b}) {
    for (const ReportFile& run : set->runs) {
      for (const auto& [path, value] : run.numbers) paths.insert(path);
    }
  }
  return {paths.begin(), paths.end()};
}

/// Returns the configuration keys that have the same two values in all comparisons.
std::vector<KeyPair> common_keys(const std::vector<Comparison>& runs) {
  std::vector<KeyPair> common = runs.front().config;
  std::erase_if(common, [&](const KeyPair& key) {
    return !std::ranges::all_of(runs, [&](const Comparison& run) {
      return std::ranges::any_of(run.config, [&](const KeyPair& other) {
        return other.key == key.key && other.a == key.a && other.b == key.b;
      });
    });
  });
  return common;
}

/// The metrics that the text shows; JSON has all metrics.
constexpr std::array<std::string_view, 10> kShownMetrics = {
    "cycles",  "time_ms",        "fps",      "fps_margin",          "dram_bytes", "energy_mj",
    "power_w", "power_at_fps_w", "area_mm2", "frames_per_joule_gpu"};

std::string rows_text(const SetComparison& c, const std::string& a, const std::string& b) {
  sim::Table table({"", "workload", a, b, "", "noise"});
  for (const SetRows& metric : c.requested.empty() ? c.metrics : c.requested) {
    if (c.requested.empty() && std::ranges::find(kShownMetrics, metric.name) == kShownMetrics.end()) continue;
    const auto value = [&](const std::optional<double>& of) {
      return of ? metric_value_text(metric.name, *of) : std::string("-");
    };
    for (const SetRow& row : metric.rows) {
      const MetricPair pair{metric.name, row.a.value_or(0), row.b.value_or(0), row.noise, metric.label};
      table.add_row({&row == &metric.rows.front() ? metric.label : "", sim::printable(row.workload), value(row.a),
                     value(row.b), row.a && row.b ? change_text(pair) : "", noise_text(pair)});
    }
  }
  return table.text();
}

}  // namespace

bool is_run_set(const fs::path& folder) {
  std::error_code failed;
  if (!fs::is_directory(folder, failed) || fs::exists(folder / "report.json", failed)) return false;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    if (fs::exists(entry.path() / "report.json", failed)) return true;
  }
  return false;
}

RunSet load_run_set(const fs::path& folder) {
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "report.json")) folders.push_back(entry.path());
  }
  std::ranges::sort(folders);
  const std::string name = fs::absolute(folder / "x").parent_path().filename().string();
  RunSet set{sim::printable(name, 40), {}};
  for (const fs::path& run : folders) set.runs.push_back(load_report(run));
  return set;
}

SetComparison compare_sets(const RunSet& a, const RunSet& b, std::span<const std::string> requested) {
  MatchedRuns matched{name_workloads(workload_keys(a)), {}, match_runs(a, b)};
  SetComparison out;
  out.workloads = matched.workloads;
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    matched.a.push_back(&a.runs[i]);
    out.runs.push_back(compare(a.runs[i], *matched.b[i]));
  }
  out.config = common_keys(out.runs);
  std::vector<const MetricPair*> metrics;  // of all workloads, in table order
  for (const Comparison& run : out.runs) {
    for (const MetricPair& pair : run.metrics) {
      const bool is_known =
          std::ranges::any_of(metrics, [&](const MetricPair* known) { return known->name == pair.name; });
      if (!is_known) metrics.push_back(&pair);
    }
  }
  for (const MetricPair* metric : metrics) {
    SetRows rows{metric->name, metric->label, {}};
    for (std::size_t i = 0; i < out.runs.size(); ++i) {
      const auto pair = std::ranges::find(out.runs[i].metrics, metric->name, &MetricPair::name);
      SetRow row{out.workloads[i], {}, {}};
      if (pair != out.runs[i].metrics.end()) row = {out.workloads[i], pair->a, pair->b, pair->noise};
      rows.rows.push_back(std::move(row));
    }
    const std::string path = "totals." + metric->label;
    if (sweep::is_metric_of_machine(path)) {
      rows.rows.resize(1);
      rows.rows.front().workload = "all";
    } else if (out.runs.size() > 1 && !out.runs.front().is_meaningless(metric->name)) {
      rows.rows.push_back(evaluate_row("mean", {SetMetric::Kind::kMean, path, {}}, matched));
      rows.rows.push_back(evaluate_row("geomean", {SetMetric::Kind::kGeomean, path, {}}, matched));
      if (sweep::is_larger_better(path)) {
        rows.rows.push_back(evaluate_row("worst", {SetMetric::Kind::kWorst, path, {}}, matched));
      }
    }
    out.metrics.push_back(std::move(rows));
  }
  const std::vector<std::string> paths = requested.empty() ? std::vector<std::string>() : all_paths(a, b);
  for (const std::string& text : requested) out.requested.push_back(requested_rows(text, paths, matched, out.metrics));
  return out;
}

std::string set_comparison_text(std::span<const RunSet> sets, std::span<const SetComparison> against) {
  std::string out;
  for (std::size_t i = 0; i < against.size(); ++i) {
    const SetComparison& c = against[i];
    out += fmt::format("{}{} against {}, {} workloads\n\n{}", i == 0 ? "" : "\n", sets[i + 1].name, sets[0].name,
                       c.workloads.size(), rows_text(c, sets[0].name, sets[i + 1].name));
    bool assumed = false, measured = false, has_worst = false;
    for (const SetRows& metric : c.requested.empty() ? c.metrics : c.requested) {
      for (const SetRow& row : metric.rows) {
        has_worst = has_worst || row.workload == "worst";
        if (row.noise) (row.noise->measured ? measured : assumed) = true;
      }
    }
    if (measured) out += "noise: differences of the means of replicates, 95 % intervals\n";
    if (assumed) out += "noise: assumed for this size of picture; --replicates 5 measures it\n";
    if (has_worst) out += "worst is the lowest value of a metric that is better when high, else the highest\n";
    out += fmt::format("\n{} against {}: {}", sets[i + 1].name, sets[0].name, config_text(c.config));
    const std::vector<const ReportFile*> of_b = match_runs(sets[0], sets[i + 1]);
    out += "\nexplained by\n";
    for (std::size_t w = 0; w < c.workloads.size(); ++w) {
      out += fmt::format("  raywatt compare {} {}\n", sim::printable(sets[0].runs[w].file.parent_path().string(), 4096),
                         sim::printable(of_b[w]->file.parent_path().string(), 4096));
    }
  }
  return out;
}

sim::Json set_comparison_json(std::span<const RunSet> sets, std::span<const SetComparison> against) {
  using sim::Json;
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  Json out = {{"schema", "raywatt-compare-sets/1"}, {"a", sets[0].name}, {"against", Json::array()}};
  for (std::size_t i = 0; i < against.size(); ++i) {
    const SetComparison& c = against[i];
    const std::vector<const ReportFile*> of_b = match_runs(sets[0], sets[i + 1]);
    Json config = Json::array(), figures = Json::object(), runs = Json::array();
    for (const KeyPair& key : c.config) config.push_back({{"key", key.key}, {"a", key.a}, {"b", key.b}});
    std::vector<SetRows> all = c.metrics;
    all.insert(all.end(), c.requested.begin(), c.requested.end());
    for (const SetRows& metric : all) {
      for (const SetRow& row : metric.rows) {
        Json& cell = figures[metric.name][sim::printable(row.workload, 1000)];
        cell = {{"a", number(row.a)}, {"b", number(row.b)}};
        cell["relative"] = row.a && row.b && *row.a != 0 ? Json(*row.b / *row.a) : Json();
        if (row.noise) cell["noise"] = noise_json(*row.noise);
      }
    }
    for (std::size_t w = 0; w < c.workloads.size(); ++w) {
      Json run = comparison_json({sets[0].runs[w], *of_b[w]}, {c.runs[w]});
      runs.push_back({{"workload", sim::printable(c.workloads[w], 1000)}, {"a", run["a"]}});
      runs.back().update(run["against"][0]);
    }
    out["against"].push_back({{"b", sets[i + 1].name},
                              {"workloads", c.workloads},
                              {"config", std::move(config)},
                              {"figures", std::move(figures)},
                              {"runs", std::move(runs)}});
  }
  return out;
}

std::vector<std::string> set_comparison_warnings(std::span<const RunSet> sets, std::span<const SetComparison> against) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < against.size(); ++i) {
    const std::vector<const ReportFile*> of_b = match_runs(sets[0], sets[i + 1]);
    for (std::size_t w = 0; w < of_b.size(); ++w) {
      for (std::string& line : comparison_warnings({sets[0].runs[w], *of_b[w]}, {against[i].runs[w]})) {
        if (std::ranges::find(out, line) == out.end()) out.push_back(std::move(line));
      }
    }
  }
  return out;
}

}  // namespace tools
