#include "tools/studies/optimise/evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "sim/io/json.h"
#include "tools/analysis/report_file.h"
#include "tools/pricing/energy_study.h"
#include "tools/studies/optimise/surrogate.h"
#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::optimise {

using Fold = sweep::SetMetric::Kind;

bool Trial::is_complete() const {
  return !seen.empty() && std::ranges::all_of(seen, [](const auto& s) { return s.has_value(); });
}

std::vector<std::string> Trial::extrapolations() const {
  std::vector<std::string> all;
  for (const WorkloadRun& run : best_runs()) {
    for (const std::string& line : run.extrapolations) {
      if (std::ranges::find(all, line) == all.end()) all.push_back(line);
    }
  }
  return all;
}

std::string resolve_metric(const Goal& goal, std::span<const std::string> paths,
                           std::span<const std::string> workloads) {
  try {
    std::string path = resolve_report_path(goal.metric, paths);
    if (goal.is_objective()) sweep::check_ranks_machines(goal.set_metric(), path, workloads);
    return path;
  } catch (const sim::InputError& error) {
    throw sim::InputError(fmt::format("{}: {}", goal.at, error.what()));
  }
}

void Evaluator::resolve_goals(std::size_t workload, const ReportFile& report) {
  std::vector<std::string> paths;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    if (is_resolved_[g] || !needs_workload(goals_[g], workload)) continue;
    if (paths.empty()) {
      for (const auto& [path, value] : report.numbers) paths.push_back(path);
    }
    goals_[g].metric = resolve_metric(goals_[g], paths, workloads_);
    is_resolved_[g] = true;
  }
}

void Evaluator::read_run(WorkloadRun& run, const sweep::Store& store) {
  const std::optional<std::string> bytes = store.read_report(run.point.id);
  if (!bytes) throw sim::IoError(fmt::format("{}: the result is gone", store.folder_of(run.point.id).string()));
  ReportFile report = parse_report(*bytes, store.folder_of(run.point.id) / "report.json");
  rank_identical_pictures(report);
  run.extrapolations = results::extrapolation_lines(report.json);
  resolve_goals(run.workload, report);
  std::optional<TableDraws> draws;
  for (const Goal& goal : goals_) {
    const bool has_value = report.has(goal.metric) && std::isfinite(report.number(goal.metric));
    if (!has_value && !needs_workload(goal, run.workload)) {
      run.seen.push_back({.value = std::numeric_limits<double>::quiet_NaN()});
      run.compared.push_back(run.seen.back().value);
      continue;
    }
    if (!has_value) {
      run.status = PointStatus::kFailed;
      run.error = fmt::format("its report has no {}", goal.metric);
      run.seen.clear();
      run.compared.clear();
      return;
    }
    const MeasuredMetric& seen = run.seen.emplace_back(results::read_noisy_metric(report, goal.metric));
    run.compared.push_back(seen.value);
    if (goal.is_objective() || confidence_ == 0) continue;
    if (!draws) draws.emplace(report);
    run.compared.back() =
        draws->uncertainty_of(goal.metric, seen).quantile(goal.is_upper_limit() ? confidence_ : 1 - confidence_);
  }
}

bool Evaluator::needs_workload(const Goal& goal, std::size_t workload) const {
  if (goal.fold == Fold::kOn) return goal.workload == workloads_[workload];
  return true;
}

std::optional<std::size_t> Evaluator::find_broken_limit(const WorkloadRun& run, std::size_t workload) const {
  if (!run.is_done()) return std::nullopt;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    const Goal& goal = goals_[g];
    const bool is_alone = workloads_.size() == 1 || goal.fold == Fold::kOn || goal.applies_to_each_workload();
    if (goal.is_objective() || !is_alone || !needs_workload(goal, workload)) continue;
    const double value = run.compared[g];
    if (!goal.is_met(value) && std::abs(value - goal.limit) > run.seen[g].half_width()) return g;
  }
  return std::nullopt;
}

bool Evaluator::is_doubtful(const Trial& trial) const {
  if (trial.status != PointStatus::kDone || trial.is_first_look || trial.is_feasible) return false;
  if (!trial.is_complete() || !trial.is_on_all_workloads()) return false;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    const Goal& goal = goals_[g];
    if (goal.is_objective()) continue;
    const double value = trial.compared[g].value_or(trial.value(g));
    if (!goal.is_met(value) && std::abs(value - goal.limit) > trial.seen[g]->half_width()) return false;
  }
  return true;
}

std::vector<sweep::WorkloadValue> Evaluator::values_of(const std::vector<WorkloadRun>& runs, std::size_t goal) const {
  std::vector<sweep::WorkloadValue> values;
  for (std::size_t w = 0; w < runs.size(); ++w) {
    values.push_back({workloads_[w], runs[w].is_done() ? std::optional(runs[w].seen[goal]) : std::nullopt});
  }
  return values;
}

void Evaluator::set_goal_values(Trial& trial) const {
  const std::vector<WorkloadRun>& runs = trial.best_runs();
  trial.seen.assign(goals_.size(), std::nullopt);
  trial.compared.assign(goals_.size(), std::nullopt);
  trial.is_feasible = trial.status == PointStatus::kDone;
  for (std::size_t g = 0; g < goals_.size(); ++g) {
    const Goal& goal = goals_[g];
    std::vector<sweep::WorkloadValue> values = values_of(runs, g);
    const bool is_each = goal.fold == Fold::kEach || goal.fold == Fold::kWorst;
    const bool is_incomplete = std::ranges::any_of(values, [](const auto& v) { return !v.seen; });
    // For a machine that was ruled out, the worst of the simulated workloads is used.
    if (is_each && (!goal.is_objective() || sweep::is_metric_of_machine(goal.metric))) {
      std::erase_if(values, [](const auto& v) { return !v.seen; });
    }
    trial.seen[g] = sweep::evaluate_set_metric(goal.set_metric(), values, goal.is_larger_better());
    if (goal.is_objective()) continue;
    for (sweep::WorkloadValue& value : values) {
      const auto w = static_cast<std::size_t>(std::ranges::find(workloads_, value.workload) - workloads_.begin());
      if (value.seen) *value.seen = {.value = runs[w].compared[g]};
    }
    const auto compared = sweep::evaluate_set_metric(goal.set_metric(), values, goal.is_larger_better());
    if (compared) trial.compared[g] = compared->value;
    const bool needs_all = goal.fold != Fold::kOn;
    trial.is_feasible = trial.is_feasible && compared && goal.is_met(compared->value) && !(needs_all && is_incomplete);
  }
  trial.is_feasible = trial.is_feasible && trial.is_complete();
}

LimitProbabilities Evaluator::limit_probabilities_of(const Trial& trial, const sweep::Store& store) const {
  const std::vector<WorkloadRun>& runs = trial.best_runs();
  std::vector<std::vector<MetricUncertainty>> spreads;  // by workload, then goal
  for (const WorkloadRun& run : runs) {
    std::vector<MetricUncertainty>& of_run = spreads.emplace_back();
    const std::optional<std::string> bytes = store.read_report(run.point.id);
    if (!bytes) throw sim::IoError(fmt::format("{}: the result is gone", store.folder_of(run.point.id).string()));
    const ReportFile report = parse_report(*bytes, store.folder_of(run.point.id) / "report.json");
    TableDraws draws(report);
    for (std::size_t g = 0; g < goals_.size(); ++g)
      of_run.push_back(draws.uncertainty_of(goals_[g].metric, run.seen[g]));
  }
  LimitProbabilities odds{std::vector<double>(goals_.size()), 0, {}};
  std::vector<std::vector<double>> drawn(goals_.size());
  for (std::size_t draw = 0; draw < kTableDraws; ++draw) {
    double all = 1;
    for (std::size_t g = 0; g < goals_.size(); ++g) {
      const Goal& goal = goals_[g];
      std::vector<sweep::WorkloadValue> values;
      for (std::size_t w = 0; w < runs.size(); ++w) values.push_back({workloads_[w], spreads[w][g].at(draw)});
      const auto seen = sweep::evaluate_set_metric(goal.set_metric(), values, goal.is_larger_better());
      drawn[g].push_back(seen ? seen->value : 0);
      double chance = seen && !goal.is_objective() ? probability_met(goal, *seen) : 1;
      // The limit must be met on each workload. Their noise is independent, except that the area is the same on all.
      if (!goal.is_objective() && goal.applies_to_each_workload() && !sweep::is_metric_of_machine(goal.metric)) {
        chance = 1;
        for (const sweep::WorkloadValue& value : values) chance *= probability_met(goal, *value.seen);
      }
      odds.met[g] += chance / double{kTableDraws};
      all *= chance;
    }
    odds.all += all / double{kTableDraws};
  }
  for (std::vector<double>& values : drawn) {
    std::ranges::sort(values);
    odds.bands.emplace_back(values[kTableDraws / 10], values[kTableDraws - 1 - kTableDraws / 10]);
  }
  return odds;
}

namespace {

constexpr const char* kArea = "totals.area_mm2";
constexpr std::uint64_t kAreaSeed = 0x61726561;  // differs from the seeds of energy entries

/// Returns the probability that a normal variable is at most `limit`.
double normal_at_most(double limit, double mean, double error) {
  return std::exp(log_probability({mean, error}, limit, false));
}

}  // namespace

sim::Band band_at(const ReportFile& report, const std::string& path) {
  return {report.number(path + ".low"), report.number(path + ".nominal"), report.number(path + ".high")};
}

double area_at(const sim::Band& band, double quantile) { return value_at_quantile(band, quantile); }

MeasuredMetric MetricUncertainty::at(std::size_t draw) const {
  MeasuredMetric scaled = seen;
  scaled.value *= factor(draw);
  if (scaled.draws) {
    scaled.draws->mean *= factor(draw);
    scaled.draws->deviation *= factor(draw);
  }
  return scaled;
}

double MetricUncertainty::quantile(double share) const {
  const double error = seen.standard_error();
  if (factors.empty() && error == 0) return seen.value;
  const auto share_below = [&](double value) {
    if (factors.empty()) return normal_at_most(value, seen.value, error);
    double sum = 0;
    for (const double f : factors) sum += normal_at_most(value, seen.value * f, error * f);
    return sum / static_cast<double>(factors.size());
  };
  const auto [least, most] = factors.empty() ? std::ranges::minmax_result<double>{1, 1} : std::ranges::minmax(factors);
  constexpr double kWide = 8;  // standard deviations
  double low = std::min(seen.value * least, seen.value * most) - kWide * error * most;
  double high = std::max(seen.value * least, seen.value * most) + kWide * error * most;
  for (int step = 0; step < 60 && low < high; ++step) {
    const double middle = (low + high) / 2;
    (share_below(middle) < share ? low : high) = middle;
  }
  return high;
}

double probability_met(const Goal& goal, const MeasuredMetric& seen) {
  const double error = seen.standard_error();
  if (error == 0) return goal.is_met(seen.value) ? 1 : 0;
  return std::exp(log_probability({seen.value, error}, goal.limit, !goal.is_upper_limit()));
}

MetricUncertainty TableDraws::uncertainty_of(const std::string& path, const MeasuredMetric& seen) {
  MetricUncertainty spread{seen, {}};
  const auto energy = energy_metric(path);
  if (!energy && path != kArea) return spread;
  auto [entry, is_new] = factors_.try_emplace(energy ? energy->block : kArea);
  std::vector<double>& factors = entry->second;
  if (is_new && energy) {
    if (!priced_) priced_ = std::make_unique<PricedRun>(report_);
    const double nominal = nominal_energy_pj(*priced_, energy->block);
    factors = energy_by_draw_pj(*priced_, energy->block, kTableDraws);
    for (double& pj : factors) pj /= nominal;
  } else if (is_new) {
    const sim::Band band = band_at(report_, "totals.area_band_mm2");
    for (std::uint64_t draw = 0; draw < kTableDraws; ++draw) {
      factors.push_back(area_at(band, sim::hash_to_unit_float(sim::hash(kAreaSeed, draw))) / band.nominal);
    }
  }
  spread.factors = factors;
  if (energy && energy->inverse) {
    for (double& factor : spread.factors) factor = 1 / factor;
  }
  return spread;
}

}  // namespace tools::optimise
