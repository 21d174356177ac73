#include "tools/studies/optimise/search_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/spec/condition.h"

namespace tools::optimise {
namespace {

using sweep::Point;

constexpr std::uint64_t kFirstShare = 5;       // a fifth of the budget is spread over the space
constexpr std::size_t kLooks = 4;              // first looks per simulated point
constexpr std::uint64_t kMostImpossible = 10;  // impossible points tolerated for each point of the budget
constexpr double kIdentical = 100;             // PSNR in dB given to a picture that is identical to its reference

/// True if the values of an axis are numbers in ascending or descending order.
bool is_ordered(const sweep::Axis& axis) {
  for (std::size_t k = 0; k < axis.keys.size(); ++k) {
    bool rises = true, falls = true;
    std::optional<sweep::Magnitude> before;
    for (const sweep::Axis::Value& value : axis.values) {
      const std::optional<sweep::Magnitude> here = sweep::parse_magnitude(value.settings[k]);
      if (!here || (before && before->kind != here->kind)) return false;
      rises = rises && (!before || before->value <= here->value);
      falls = falls && (!before || before->value >= here->value);
      before = here;
    }
    if (!rises && !falls) return false;
  }
  return true;
}

Space space_of(const Task& task, const sweep::Planner& planner) {
  Space space;
  for (const sweep::Axis& axis : task.space.axes) {
    space.axes.push_back({static_cast<std::uint32_t>(axis.values.size()), is_ordered(axis)});
  }
  space.is_wanted = [&planner](const Choice& choice) { return planner.is_wanted(choice); };
  return space;
}

void check_looks(const Task& task) {
  parse_tile_sampling(task.looks_sampling, "none");
  if (!task.space.reference.empty()) {
    throw sim::InputError("does not go together with a reference; allowed: fidelity full");
  }
  check_tile_sampling(kernels::parse_program(task.space.program));
  for (const sweep::Axis& axis : task.space.axes) {
    for (std::size_t k = 0; k < axis.keys.size(); ++k) {
      if (axis.keys[k] != "program") continue;
      for (const sweep::Axis::Value& value : axis.values)
        check_tile_sampling(kernels::parse_program(value.settings[k]));
    }
  }
}

/// Returns the numbers of a report. The infinite PSNR of an identical picture is replaced by kIdentical.
std::vector<ReportNumber> metric_values_of(sim::Json json) {
  const sim::JsonPointer identical("/totals/identical");
  if (json.contains(identical) && json[identical] == true) json["totals"]["psnr_db"] = kIdentical;
  return report_numbers(json);
}

/// Returns a number of a report with its noise: of its replicates, or as assumed for the size of the picture.
MeasuredFigure seen_figure(const std::vector<ReportNumber>& numbers, const ReportNumber& metric) {
  const auto at = [&](const std::string& path) -> std::optional<double> {
    const auto found = std::ranges::find(numbers, path, &ReportNumber::path);
    return found == numbers.end() ? std::nullopt : std::optional(found->value);
  };
  const std::string name = is_totals_path(metric.path) ? metric_name(metric.path) : std::string();
  if (!is_noisy(name)) return {.value = metric.value};
  const std::string draws = "totals.replicates.figures." + name;
  const auto count = at("totals.replicates.count"), mean = at(draws + ".mean"), deviation = at(draws + ".deviation");
  if (count && mean && deviation) return {*mean, Draws{static_cast<std::size_t>(*count), *mean, *deviation}};
  return {metric.value, std::nullopt,
          default_noise(at("resolution[0]").value_or(0) * at("resolution[1]").value_or(0), name)};
}

}  // namespace

SearchRun::SearchRun(const Task& task, const std::filesystem::path& folder)
    : task_(task),
      planner_(task_.space, folder),
      search_(space_of(task_, planner_), task_.goals, {.seed = task_.seed, .population = task_.population}) {
  if (!task_.sampled) return;
  try {
    check_looks(task_);
  } catch (const sim::InputError& error) {
    throw sim::InputError(fmt::format("{}: fidelity sampled: {}", task_.file, error.what()));
  }
}

void SearchRun::resolve_metrics(const std::vector<std::string>& paths) {
  for (Goal& goal : task_.goals) {
    try {
      goal.metric = resolve_report_path(goal.metric, paths);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("{}: {}", goal.at, error.what()));
    }
  }
  has_paths_ = true;
}

void SearchRun::read_metrics(Trial& trial, const sweep::Store& store) {
  const std::optional<std::string> report = store.read_report(trial.point.id);
  if (!report) throw sim::IoError(fmt::format("{}: the result is gone", store.folder_of(trial.point.id).string()));
  const auto json = sim::parse_json(*report);
  trial.extrapolations = results::extrapolation_lines(json);
  const std::vector<ReportNumber> numbers = metric_values_of(json);
  if (!has_paths_) {
    std::vector<std::string> paths;
    for (const ReportNumber& number : numbers) paths.push_back(number.path);
    resolve_metrics(paths);
  }
  trial.is_feasible = true;
  for (const Goal& goal : task_.goals) {
    const auto number = std::ranges::find(numbers, goal.metric, &ReportNumber::path);
    if (number == numbers.end() || !std::isfinite(number->value)) {
      trial.status = PointStatus::kFailed;
      trial.error = fmt::format("its report has no {}", goal.metric);
      trial.is_feasible = false;
      trial.metrics.clear();
      trial.seen.clear();
      return;
    }
    const MeasuredFigure seen = seen_figure(numbers, *number);
    trial.metrics.push_back(seen.value);
    trial.seen.push_back(seen);
    trial.is_feasible = trial.is_feasible && goal.is_met(seen.value);
  }
}

bool SearchRun::simulate_trials(std::vector<Trial>& fresh, sweep::Launcher& launcher, const sweep::Store& store,
                                const Hooks& hooks) {
  std::vector<Point> points, all;
  std::vector<std::size_t> owners;
  for (std::size_t f = 0; f < fresh.size(); ++f) {
    if (fresh[f].status == PointStatus::kImpossible) continue;
    points.push_back(fresh[f].point);
    owners.push_back(f);
  }
  if (points.empty()) return true;
  for (const Trial& trial : trials_) {
    if (trial.status != PointStatus::kImpossible) all.push_back(trial.point);
  }
  all.insert(all.end(), points.begin(), points.end());
  hooks.announce(all);
  const sweep::BatchEnd end = launcher.run(points, hooks.watch);
  if (end.interrupted) return false;
  computed_ += end.count_of(PointStatus::kComputed);
  found_ += end.count_of(PointStatus::kDone);
  for (std::size_t p = 0; p < points.size(); ++p) {
    Trial& trial = fresh[owners[p]];
    if (is_done(end.statuses[p])) {
      read_metrics(trial, store);
      continue;
    }
    if (end.statuses[p] != PointStatus::kFailed) {
      throw sim::IoError("points were not simulated because a worker stopped; run the same command again to continue");
    }
    trial.status = PointStatus::kFailed;
    const std::optional<sweep::Failure> failure = store.read_failure(trial.point.id);
    trial.error = failure ? failure->error : "it failed";
  }
  return true;
}

bool SearchRun::compute_points(const std::vector<Choice>& choices, bool looks, sweep::Launcher& launcher,
                               const sweep::Store& store, const Hooks& hooks) {
  std::vector<Trial> fresh;
  std::map<std::string, std::size_t> indices;  // index in `trials_` of each new point, by id
  std::vector<std::string> ids;
  for (const Choice& choice : choices) {
    Trial trial;
    trial.point = planner_.make_point(choice, looks ? task_.looks_sampling : "");
    trial.choice = choice;
    trial.is_look = looks;
    trial.batch = batches_;
    ids.push_back(trial.point.id);
    if (!trial.point.error.empty()) {
      trial.status = PointStatus::kImpossible;
      trial.error = trial.point.error;
    }
    const bool is_known = by_id_.contains(ids.back()) || indices.contains(ids.back());
    if (is_known) continue;  // axis values that give the same machine as an earlier point
    indices.emplace(ids.back(), fresh.size());
    fresh.push_back(std::move(trial));
  }

  if (!simulate_trials(fresh, launcher, store, hooks)) return false;
  for (Trial& trial : fresh) {
    if (!trial.is_look && trial.status != PointStatus::kImpossible) simulated_ += 1;
    by_id_.emplace(trial.point.id, trials_.size());
    trials_.push_back(std::move(trial));
  }
  for (std::size_t c = 0; c < choices.size(); ++c) {
    const Trial& trial = trials_[by_id_.at(ids[c])];
    const bool is_done = trial.status == PointStatus::kDone;
    if (looks) {
      looked_.emplace(choices[c], true);
      if (is_done) search_.add_first_look(choices[c], trial.metrics);
    } else {
      std::vector<double> errors;
      std::ranges::transform(trial.seen, std::back_inserter(errors), &MeasuredFigure::standard_error);
      const bool are_assumed = std::ranges::any_of(trial.seen, [](const MeasuredFigure& s) { return s.assumed > 0; });
      search_.add_result(choices[c], is_done ? std::optional(trial.metrics) : std::nullopt, errors, are_assumed);
    }
  }
  batches_ += 1;
  return true;
}

bool SearchRun::run(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks) {
  const std::uint64_t axes = task_.space.axes.size();
  const std::uint64_t first = std::min(std::max(task_.budget / kFirstShare, 2 * (axes + 1)), (task_.budget + 1) / 2);
  std::uint64_t proposed_count = 0;
  while (simulated_ < task_.budget && proposed_count < task_.budget * (kMostImpossible + 1)) {
    const std::size_t count = std::min(simulated_ == 0 ? first : task_.batch, task_.budget - simulated_);
    if (task_.sampled) {
      std::vector<Choice> looks = search_.propose_points(kLooks * count);
      std::erase_if(looks, [&](const Choice& choice) { return looked_.contains(choice); });
      if (!compute_points(looks, true, launcher, store, hooks)) return false;
    }
    const std::vector<Choice> proposed = search_.propose_points(count);
    if (proposed.empty()) break;
    proposed_count += proposed.size();
    if (!compute_points(proposed, false, launcher, store, hooks)) return false;
  }
  return true;
}

std::vector<const Trial*> SearchRun::feasible_trials() const {
  std::vector<const Trial*> out;
  for (const Trial& trial : trials_) {
    if (trial.is_feasible && !trial.is_look) out.push_back(&trial);
  }
  return out;
}

std::vector<const Trial*> SearchRun::pareto_front() const {
  const std::vector<const Trial*> all = feasible_trials();
  std::vector<const Trial*> pareto_front;
  std::vector<Score> scores;
  for (const Trial* trial : all) scores.push_back(search_.score_of(trial->metrics));
  for (const std::size_t i : pareto_front_of(scores)) pareto_front.push_back(all[i]);
  return pareto_front;
}

const Trial* SearchRun::least_infeasible() const {
  const Trial* nearest = nullptr;
  double least = 0;
  for (const Trial& trial : trials_) {
    if (trial.status != PointStatus::kDone || trial.is_look) continue;
    double miss = 0;
    for (std::size_t g = 0; g < task_.goals.size(); ++g) {
      const Goal& goal = task_.goals[g];
      if (goal.is_met(trial.metrics[g])) continue;
      miss += std::abs(trial.metrics[g] - goal.limit) / std::max(std::abs(goal.limit), 1e-12);
    }
    if (nearest == nullptr || miss < least) {
      nearest = &trial;
      least = miss;
    }
  }
  return nearest;
}

}  // namespace tools::optimise
