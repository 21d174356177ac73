#include "tools/studies/optimise/search_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "shader_kernels/programs/program_spec.h"
#include "sim/error.h"
#include "sim/io/printable.h"
#include "sim/report/energy.h"
#include "tools/run/frame/machine_run.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/studies/optimise/probe.h"
#include "tools/studies/sweep/spec/condition.h"

namespace tools::optimise {
namespace {

using sweep::Point;
using Fold = sweep::SetMetric::Kind;

constexpr std::uint64_t kFirstShare = 5;       // a fifth of the budget is spread over the space
constexpr std::uint64_t kNeighbourShare = 4;   // at most a quarter of the budget goes to neighbours of the best machine
constexpr int kMostDoubtful = 4;               // doubtful machines simulated whole
constexpr std::size_t kLooksPerPoint = 4;      // first looks (approximate simulations) per simulated machine
constexpr std::uint64_t kMostImpossible = 10;  // impossible machines that are tolerated per machine of the budget
/// From this share of sampled tiles on, whole frames take no longer: their rays are recorded once for all machines.
constexpr double kWorthSampling = 0.6;
constexpr double kLargePicture = 1'000'000;  // pixels that are enough for tile sampling (docs/sampling.md)

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

/// Throws InputError if a program of the task cannot be sampled by tiles.
void check_programs(const Task& task) {
  check_tile_sampling(kernels::parse_program(task.space.program));
  for (const sweep::Axis& axis : task.space.axes) {
    for (std::size_t k = 0; k < axis.keys.size(); ++k) {
      if (axis.keys[k] != "program") continue;
      for (const sweep::Axis::Value& value : axis.values)
        check_tile_sampling(kernels::parse_program(value.settings[k]));
    }
  }
}

void check_sampling(const Task& task) {
  parse_tile_sampling(task.sampling, "none");
  if (!task.space.reference.empty()) {
    throw sim::InputError("does not go together with a reference; allowed: fidelity full");
  }
  if (task.fidelity == Fidelity::kSampled) check_programs(task);  // kTiles simulates whole frames of such programs
}

/// True if frames may be simulated by sampled tiles: no setting of the sweep needs whole frames.
bool may_sample(const sweep::Spec& spec) {
  return spec.reference.empty() && spec.replicates == 1 && spec.slices == 0 && !spec.image;
}

std::vector<std::string> workload_names(const Task& task) {
  if (!task.workloads.empty()) return task.workloads;
  return {task.space.scene.empty() ? "the scene" : task.space.scene};
}

bool is_total_area(const Goal& goal) { return goal.metric == "area_mm2" || goal.metric == "totals.area_mm2"; }

/// True if the goal's metric is the same on every workload. Its path may lack the prefix "totals.".
bool is_of_machine(const Goal& goal) {
  return sweep::is_metric_of_machine(goal.metric) || sweep::is_metric_of_machine("totals." + goal.metric);
}

Task with_defaults(Task task) {
  if (task.sampling.empty()) task.sampling = task.fidelity == Fidelity::kSampled ? "auto" : "5%";
  return task;
}

}  // namespace

SearchRun::SearchRun(const Task& task, const std::filesystem::path& folder)
    : task_(with_defaults(task)),
      planner_(task_.space, folder),
      evaluator_(resolve_goals(), workload_names(task_), task_.confidence, task_.file),
      search_(make_space(), task_.goals, make_search_options()),
      ruled_out_(workloads().size()) {
  const bool is_sampled = task_.fidelity == Fidelity::kSampled || task_.fidelity == Fidelity::kTiles;
  if (is_sampled) {
    try {
      check_sampling(task_);
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("{}: fidelity {}: {}", task_.file,
                                        names_of(Fidelity{}).at(static_cast<std::size_t>(task_.fidelity)),
                                        error.what()));
    }
  }
  const Choice first(task_.machine_axes().size(), 0);
  for (std::size_t w = 0; w < workloads().size(); ++w) {
    const Point point = planner_.make_point(choice_on_workload(first, w), "");
    const RunConfig& config = keys_.config_of(point);
    const kernels::RenderConfig& render = config.render;
    starts_.emplace(names_of(config.frame.start).at(static_cast<std::size_t>(config.frame.start)));
    resolutions_.push_back(fmt::format("{}x{}", render.width, render.height));
    const bool is_large = double{1} * render.width * render.height >= kLargePicture;
    has_small_picture_ = has_small_picture_ || !is_large;
    tiled_.push_back(task_.fidelity == Fidelity::kTiles ||
                     (task_.fidelity == Fidelity::kAuto && is_large && may_sample(task_.space)));
  }
  for (const sweep::Axis& axis : task_.space.axes) {
    for (std::size_t k = 0; k < axis.keys.size(); ++k) {
      if (axis.keys[k] != "frame.start") continue;
      for (const sweep::Axis::Value& value : axis.values) starts_.insert(value.settings[k]);
    }
  }
}

/// Returns the report paths of a machine by probe_report_paths(); none if it cannot be simulated.
std::vector<std::string> SearchRun::probe_machine(const Choice& machine) {
  const Point point = planner_.make_point(choice_on_workload(machine, 0), "");
  if (!point.error.empty()) return {};
  try {
    return probe_report_paths(keys_.config_of(point), point.run_options());
  } catch (const sim::InputError&) {  // the simulations report what is wrong with the machine
    return {};
  } catch (const sim::Deadlock&) {
    return {};
  }
}

/// Gives the goals full report paths, which a tiny picture shows, and returns them. Leaves metrics that depend on the
/// scene, and all metrics if the machines at the ends of the space cannot be simulated.
std::vector<Goal> SearchRun::resolve_goals() {
  Choice machine;
  for (const AxisShape& axis : make_space().axes) machine.push_back(axis.values - 1);
  std::vector<std::string> paths = probe_machine(machine);
  if (paths.empty()) paths = probe_machine(Choice(machine.size(), 0));
  if (paths.empty()) return task_.goals;
  const std::vector<std::string> workloads = workload_names(task_);
  for (Goal& goal : task_.goals) {
    if (!may_depend_on_scene(goal.metric, paths)) goal.metric = resolve_metric(goal, paths, workloads);
  }
  return task_.goals;
}

Space SearchRun::make_space() const {
  Space space;
  for (const sweep::Axis& axis : task_.machine_axes()) {
    space.axes.push_back({static_cast<std::uint32_t>(axis.values.size()), is_ordered(axis)});
  }
  space.is_wanted = [this](const Choice& choice) {
    for (std::size_t w = 0; w < workloads().size(); ++w) {
      if (!planner_.is_wanted(choice_on_workload(choice, w))) return false;
    }
    return true;
  };
  return space;
}

/// Lists the values that the search models: each goal's metric on each workload.
Search::Options SearchRun::make_search_options() {
  Search::Options options{.seed = task_.seed, .population = task_.population};
  using Key = std::tuple<std::string, std::size_t, int>;  // metric, workload, and -1 or 1 for a lower or upper quantile
  std::map<Key, std::size_t> known;
  for (const Goal& goal : task_.goals) {
    const int side = goal.is_objective() || task_.confidence == 0 ? 0 : goal.is_upper_limit() ? 1 : -1;
    std::vector<std::size_t>& of_goal = options.figures.emplace_back();
    std::vector<std::size_t>& by_workload = figures_.emplace_back();
    for (std::size_t w = 0; w < workloads().size(); ++w) {
      const std::size_t own = is_of_machine(goal) ? 0 : w;
      const auto [entry, is_new] = known.try_emplace(Key{goal.metric, own, side}, figure_count_);
      if (is_new) {
        ++figure_count_;
        std::function<double(const Choice&)>& exact = options.exact.emplace_back();
        const double quantile = side == 0 ? 0.5 : side > 0 ? task_.confidence : 1 - task_.confidence;
        if (is_total_area(goal)) exact = [this, quantile](const Choice& c) { return exact_area(c, quantile); };
      }
      by_workload.push_back(entry->second);
      const bool is_needed = evaluator_.needs_workload(goal, w) && std::ranges::count(of_goal, entry->second) == 0;
      if (is_needed) of_goal.push_back(entry->second);
    }
  }
  const auto is_set = [](const auto& exact) { return exact != nullptr; };
  if (std::ranges::none_of(options.exact, is_set)) options.exact.clear();
  return options;
}

/// Returns a quantile of a machine's area, computed as in its reports but without a simulation.
double SearchRun::exact_area(const Choice& choice, double quantile) {
  const Point point = planner_.make_point(choice_on_workload(choice, 0), "");
  if (!point.error.empty()) return 0;
  const RunConfig& config = keys_.config_of(point);
  const std::vector<sim::UnitReport> units = idle_unit_reports(*config.gpu, optional_units_of(config), config.bvh);
  return area_at(sim::compute_area(units, config.energy, config.area).total, quantile);
}

Choice SearchRun::choice_on_workload(const Choice& machine, std::size_t workload) const {
  Choice choice = machine;
  if (!task_.workloads.empty()) choice.insert(choice.begin(), static_cast<std::uint32_t>(workload));
  return choice;
}

std::string SearchRun::tile_sampling_of(const Point& point, std::size_t workload) {
  const kernels::ProgramSpec program = kernels::parse_program(point.program);
  if (!tiled_[workload] || !point.error.empty() || program.kind != kernels::ProgramSpec::Kind::kFull) return "";
  if (task_.fidelity == Fidelity::kTiles) return task_.sampling;
  const TileSampling sampling = parse_tile_sampling(task_.sampling, "none");
  return simulated_share(keys_.config_of(point), program, sampling) < kWorthSampling ? task_.sampling : "";
}

std::string SearchRun::fidelity_text() const {
  return frames_text() + (has_small_picture_ ? "\nwarning: pictures below a million pixels do not stand for full HD "
                                               "(docs/frame-rate.md)"
                                             : "");
}

std::string SearchRun::frames_text() const {
  std::vector<std::string> sizes = resolutions_;
  std::ranges::sort(sizes);
  sizes.erase(std::ranges::unique(sizes).begin(), sizes.end());
  const std::string at = fmt::format("{}, {} start", fmt::join(sizes, ", "), fmt::join(starts_, " or "));
  if (is_tiled()) {
    const char* const where = task_.fidelity == Fidelity::kAuto ? " where that is quicker" : "";
    const char* const whole = has_one_objective() ? "the best" : "the front only with --check";
    return fmt::format("tile sampling of {} at {}{}; whole frames of {}; never a smaller picture", task_.sampling, at,
                       where, whole);
  }
  if (task_.fidelity == Fidelity::kSampled) {
    return fmt::format("first looks by tile sampling ({}), then whole frames of {}", task_.sampling, at);
  }
  return fmt::format("whole frames of {}", at);
}

Trial SearchRun::make_trial(const Choice& choice, bool is_first_look) {
  Trial trial;
  trial.choice = choice;
  trial.is_first_look = is_first_look;
  trial.batch = batches_;
  for (std::size_t w = 0; w < workloads().size(); ++w) {
    const Choice here = choice_on_workload(choice, w);
    WorkloadRun run{.workload = w};
    run.point = planner_.make_point(here, is_first_look ? task_.sampling : "");
    const std::string sampling = is_first_look ? "" : tile_sampling_of(run.point, w);
    if (!sampling.empty()) run.point = planner_.make_point(here, sampling);
    if (!run.point.error.empty() && trial.error.empty()) {
      trial.status = PointStatus::kImpossible;
      trial.error = run.point.error;
    }
    trial.runs.push_back(std::move(run));
  }
  trial.id = trial.runs.front().point.id;
  trial.axes = trial.runs.front().point.axes;
  if (!task_.workloads.empty()) trial.axes.erase(trial.axes.begin());
  return trial;
}

std::vector<std::size_t> SearchRun::workload_order() const {
  std::vector<std::size_t> order;
  for (std::size_t w = 0; w < workloads().size(); ++w) order.push_back(w);
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t w) { return ruled_out_[w]; });
  return order;
}

std::vector<Point> SearchRun::points(bool with_looks) const {
  std::vector<Point> all;
  for (const Trial& trial : trials_) {
    if (trial.is_first_look && !with_looks) continue;
    for (const WorkloadRun& run : trial.runs) {
      if (run.status != PointStatus::kMissing) all.push_back(run.point);
    }
  }
  for (const Trial& trial : trials_) {
    for (std::size_t w = 0; w < trial.whole.size(); ++w) {
      if (trial.whole[w].point.id != trial.runs[w].point.id) all.push_back(trial.whole[w].point);
    }
  }
  return all;
}

bool SearchRun::simulate_runs(const std::vector<WorkloadRun*>& runs, const std::vector<Point>& others,
                              const Machines& with) {
  if (runs.empty()) return true;
  std::vector<Point> points, all = others;
  for (const WorkloadRun* run : runs) points.push_back(run->point);
  all.insert(all.end(), points.begin(), points.end());
  with.hooks.announce(all);
  const sweep::BatchResult end = with.launcher.run(points, with.hooks.watch);
  if (end.interrupted) return false;
  computed_ += end.count_of(PointStatus::kComputed);
  found_ += end.count_of(PointStatus::kDone);
  for (std::size_t p = 0; p < points.size(); ++p) {
    WorkloadRun& run = *runs[p];
    if (is_done(end.statuses[p])) {
      run.status = PointStatus::kDone;
      evaluator_.read_run(run, with.store);
      continue;
    }
    if (end.statuses[p] != PointStatus::kFailed) {
      throw sim::IoError("runs are missing because a worker stopped; run the same command again to continue");
    }
    run.status = PointStatus::kFailed;
    const std::optional<sweep::Failure> failure = with.store.read_failure(run.point.id);
    run.error = failure ? failure->error : "it failed";
  }
  return true;
}

bool SearchRun::simulate_trials(std::vector<Trial>& fresh, const Machines& with) {
  std::vector<Trial*> open;
  for (Trial& trial : fresh) {
    if (trial.status == PointStatus::kDone) open.push_back(&trial);
  }
  std::vector<Point> others = points(true);
  for (const std::size_t w : workload_order()) {
    std::vector<WorkloadRun*> now;
    for (Trial* trial : open) now.push_back(&trial->runs[w]);
    if (!simulate_runs(now, others, with)) return false;
    for (const WorkloadRun* run : now) others.push_back(run->point);
    std::erase_if(open, [&](Trial* trial) {
      const WorkloadRun& run = trial->runs[w];
      if (run.status == PointStatus::kFailed) {
        trial->status = PointStatus::kFailed;
        trial->error = workloads().size() == 1 ? run.error : fmt::format("{}: {}", workloads()[w], run.error);
        return true;
      }
      if (!evaluator_.find_broken_limit(run, w)) return false;
      ruled_out_[w] += 1;
      trial->ruled_out_by = w;
      return true;
    });
  }
  return true;
}

/// Returns a machine's value of each metric that the search models, on each workload. Sets `errors` to standard errors.
MetricValues SearchRun::figure_values(const std::vector<WorkloadRun>& runs, std::vector<double>& errors,
                                      bool& are_assumed) const {
  MetricValues values(figure_count_);
  errors.assign(figure_count_, 0);
  for (std::size_t g = 0; g < figures_.size(); ++g) {
    for (std::size_t w = 0; w < runs.size(); ++w) {
      if (!runs[w].is_done() || !evaluator_.needs_workload(goals()[g], w)) continue;
      values[figures_[g][w]] = runs[w].compared[g];
      errors[figures_[g][w]] = runs[w].seen[g].standard_error();
      are_assumed = are_assumed || runs[w].seen[g].assumed > 0;
    }
  }
  return values;
}

void SearchRun::add_to_search(const Trial& trial, const Choice& choice) {
  std::vector<double> errors;
  bool are_assumed = false;
  const MetricValues values = figure_values(trial.best_runs(), errors, are_assumed);
  const bool is_done = trial.status == PointStatus::kDone;
  if (trial.is_first_look) {
    if (is_done) search_.add_first_look(choice, values);
  } else if (!is_done) {
    search_.add_result(choice, std::nullopt);
  } else if (trial.whole.empty()) {
    search_.add_partial_result(choice, values, errors, are_assumed);
  } else {
    search_.replace_result(choice, values, errors, are_assumed);
  }
}

bool SearchRun::compute_machines(const std::vector<Choice>& choices, bool is_first_look, const Machines& with) {
  std::vector<Trial> fresh;
  std::map<std::string, std::size_t> indices;  // index in `trials_` of each new machine, by id
  std::vector<std::string> ids;
  for (const Choice& choice : choices) {
    Trial trial = make_trial(choice, is_first_look);
    ids.push_back(trial.id);
    const bool is_known = by_id_.contains(ids.back()) || indices.contains(ids.back());
    if (is_known) continue;  // other axis values give the same machine
    indices.emplace(ids.back(), fresh.size());
    fresh.push_back(std::move(trial));
  }
  if (!simulate_trials(fresh, with)) return false;
  for (Trial& trial : fresh) {
    evaluator_.set_goal_values(trial);
    if (!trial.is_first_look && trial.status != PointStatus::kImpossible) {
      simulated_ += 1;
      skipped_ +=
          static_cast<std::uint64_t>(std::ranges::count(trial.runs, PointStatus::kMissing, &WorkloadRun::status));
    }
    by_id_.emplace(trial.id, trials_.size());
    trials_.push_back(std::move(trial));
  }
  for (std::size_t c = 0; c < choices.size(); ++c) {
    const std::size_t index = by_id_.at(ids[c]);
    if (is_first_look) {
      looked_.insert(choices[c]);
    } else {
      by_choice_.emplace(choices[c], index);
    }
    add_to_search(trials_[index], choices[c]);
  }
  batches_ += 1;
  return true;
}

/// Simulates proposed machines until the search has simulated `until` machines. Returns false if interrupted.
bool SearchRun::simulate_proposed_until(std::uint64_t until, const Machines& with) {
  const std::uint64_t axes = task_.machine_axes().size();
  const std::uint64_t first = std::min(std::max(task_.budget / kFirstShare, 2 * (axes + 1)), (task_.budget + 1) / 2);
  while (simulated_ < until && proposed_ < task_.budget * (kMostImpossible + 1)) {
    const std::size_t count = std::min(simulated_ == 0 ? std::min(first, until) : task_.batch, until - simulated_);
    if (task_.fidelity == Fidelity::kSampled) {
      std::vector<Choice> looks = search_.propose_points(kLooksPerPoint * count);
      std::erase_if(looks, [&](const Choice& choice) { return looked_.contains(choice); });
      if (!compute_machines(looks, true, with)) return false;
    }
    const std::vector<Choice> proposed = search_.propose_points(count);
    if (proposed.empty()) break;
    proposed_ += proposed.size();
    if (!compute_machines(proposed, false, with)) return false;
  }
  return true;
}

/// Returns the neighbours of the best machine (one axis differs) that are not simulated.
std::vector<Choice> SearchRun::unknown_neighbours() {
  const std::vector<const Trial*> front = pareto_front();
  if (front.empty()) return {};
  std::vector<Choice> near = search_.neighbours_of(front.front()->choice);
  std::erase_if(near, [&](const Choice& c) { return search_.is_known(c) || !search_.is_wanted(c); });
  return near;
}

/// Spends the rest of the budget on neighbours of the best machine, and when all are simulated, on proposed machines.
bool SearchRun::refine_best(const Machines& with) {
  while (simulated_ < task_.budget) {
    const std::uint64_t before = simulated_;
    std::vector<Choice> near = unknown_neighbours();
    near.resize(std::min<std::size_t>(near.size(), task_.budget - simulated_));
    if (!near.empty()) {
      if (!compute_machines(near, false, with)) return false;
    } else if (!simulate_proposed_until(std::min<std::uint64_t>(task_.budget, simulated_ + task_.batch), with)) {
      return false;
    }
    if (simulated_ == before && near.empty()) return true;  // the space has no other machines
  }
  return true;
}

bool SearchRun::simulate_whole(const Trial& sampled, const Machines& with) {
  const std::size_t index = index_of(sampled);
  Trial& trial = trials_[index];
  std::vector<WorkloadRun> whole;
  for (std::size_t w = 0; w < workloads().size(); ++w) {
    WorkloadRun& run = whole.emplace_back(WorkloadRun{.workload = w});
    run.point = planner_.make_point(choice_on_workload(trial.choice, w), "");
    if (run.point.id == trial.runs[w].point.id) run = trial.runs[w];  // its frames were simulated whole already
  }
  std::vector<WorkloadRun*> now;
  for (WorkloadRun& run : whole) {
    if (run.status == PointStatus::kMissing) now.push_back(&run);
  }
  if (!simulate_runs(now, points(true), with)) return false;
  for (const WorkloadRun& run : whole) {
    if (run.status != PointStatus::kFailed) continue;
    trial.status = PointStatus::kFailed;
    trial.error = run.error;
  }
  trial.whole = std::move(whole);
  evaluator_.set_goal_values(trial);
  for (const auto& [choice, known] : by_choice_) {
    if (known == index) add_to_search(trial, choice);
  }
  return true;
}

const Trial* SearchRun::find_doubtful() const {
  std::vector<Score> front;
  for (const Trial* trial : pareto_front()) front.push_back(score_of(*trial));
  const Trial* best = nullptr;
  for (const Trial& trial : trials_) {
    const bool is_open = trial.whole.empty() && trial.is_sampled() && evaluator_.is_doubtful(trial);
    if (!is_open) continue;
    const Score score = score_of(trial);
    const auto is_as_good = [&](const Score& other) { return std::ranges::equal(score, other, std::less_equal{}); };
    if (std::ranges::any_of(front, is_as_good)) continue;
    if (best == nullptr || score_of(*best) < score) best = &trial;
  }
  return best;
}

/// Simulates whole frames of machines until every machine on the Pareto front has them.
bool SearchRun::simulate_whole_front(const Machines& with) {
  while (true) {
    const std::vector<const Trial*> front = pareto_front();
    const auto open = std::ranges::find_if(front, [](const Trial* trial) { return trial->whole.empty(); });
    if (open != front.end()) {
      if (!simulate_whole(**open, with)) return false;
      continue;
    }
    const Trial* const doubtful = doubtful_ < kMostDoubtful ? find_doubtful() : nullptr;
    if (doubtful == nullptr) return true;
    doubtful_ += 1;
    if (!simulate_whole(*doubtful, with)) return false;
  }
}

bool SearchRun::check_front(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks) {
  return simulate_whole_front({launcher, store, hooks});
}

/// Simulates all machines of the space.
bool SearchRun::simulate_space(const Machines& with) {
  std::vector<std::uint32_t> sizes;
  for (const sweep::Axis& axis : task_.machine_axes()) sizes.push_back(static_cast<std::uint32_t>(axis.values.size()));
  const std::vector<Choice> all =
      sweep::choose_combinations({}, sizes, [this](const Choice& choice) { return search_.is_wanted(choice); });
  for (std::size_t done = 0; done < all.size(); done += task_.batch) {
    const std::size_t count = std::min<std::size_t>(task_.batch, all.size() - done);
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(done);
    if (!compute_machines({begin, begin + static_cast<std::ptrdiff_t>(count)}, false, with)) return false;
  }
  return true;
}

bool SearchRun::run(sweep::Launcher& launcher, const sweep::Store& store, const Hooks& hooks) {
  const Machines with{launcher, store, hooks};
  const bool is_single = has_one_objective();
  if (task_.simulates_all) {
    if (!simulate_space(with)) return false;
    return !is_single || !is_tiled() || simulate_whole_front(with);
  }
  std::uint64_t reserve = 0;
  if (is_single) {
    for (const sweep::Axis& axis : task_.machine_axes()) reserve += axis.values.size() > 1 ? 2 : 0;
    reserve = std::min(reserve, task_.budget / kNeighbourShare);
  }
  if (!simulate_proposed_until(task_.budget - reserve, with)) return false;
  if (!is_single) return true;
  // The results of whole frames may reject the best machine, so that the search must continue.
  while (true) {
    if (!refine_best(with)) return false;
    if (!is_tiled()) return true;
    const auto is_whole = [](const Trial& trial) { return !trial.whole.empty(); };
    const auto before = std::ranges::count_if(trials_, is_whole);
    if (!simulate_whole_front(with)) return false;
    if (std::ranges::count_if(trials_, is_whole) == before) return true;
  }
}

bool SearchRun::has_one_objective() const { return std::ranges::count_if(goals(), &Goal::is_objective) == 1; }

Score SearchRun::score_of(const Trial& trial) const {
  std::vector<double> values;
  for (std::size_t g = 0; g < goals().size() && goals()[g].is_objective(); ++g) values.push_back(trial.value(g));
  return search_.score_of(values);
}

std::vector<const Trial*> SearchRun::feasible_trials() const {
  std::vector<const Trial*> out;
  for (const Trial& trial : trials_) {
    if (trial.is_feasible && !trial.is_first_look) out.push_back(&trial);
  }
  return out;
}

std::vector<const Trial*> SearchRun::pareto_front() const {
  const std::vector<const Trial*> all = feasible_trials();
  std::vector<const Trial*> front;
  std::vector<Score> scores;
  for (const Trial* trial : all) scores.push_back(score_of(*trial));
  for (const std::size_t i : pareto_front_of(scores)) front.push_back(all[i]);
  return front;
}

const Trial* SearchRun::least_infeasible() const {
  const Trial* nearest = nullptr;
  std::pair<bool, double> least;
  for (const Trial& trial : trials_) {
    if (trial.status != PointStatus::kDone || trial.is_first_look) continue;
    double miss = 0;
    for (std::size_t g = 0; g < goals().size(); ++g) {
      const Goal& goal = goals()[g];
      if (goal.is_objective() || !trial.compared[g] || goal.is_met(*trial.compared[g])) continue;
      miss += std::abs(*trial.compared[g] - goal.limit) / std::max(std::abs(goal.limit), 1e-12);
    }
    // Machines with results on all workloads are preferred: one that was ruled out may break more limits on the others.
    const std::pair rank(!trial.is_on_all_workloads(), miss);
    if (nearest == nullptr || rank < least) {
      nearest = &trial;
      least = rank;
    }
  }
  return nearest;
}

std::vector<Neighbour> SearchRun::neighbours_of(const Trial& trial) {
  std::vector<Neighbour> all;
  std::vector<Choice> choices = search_.neighbours_of(trial.choice);
  std::erase_if(choices, [&](const Choice& choice) { return !search_.is_wanted(choice); });
  const auto estimates = search_.estimate_figures(choices);
  for (std::size_t c = 0; c < choices.size(); ++c) {
    Neighbour& near = all.emplace_back();
    near.choice = choices[c];
    for (std::size_t a = 0; a < choices[c].size(); ++a) {
      if (choices[c][a] == trial.choice[a]) continue;
      const sweep::Axis& axis = task_.machine_axes()[a];
      near.axis = axis.name;
      near.from = axis.values[trial.choice[a]].label;
      near.to = axis.values[choices[c][a]].label;
    }
    for (std::size_t g = 0; g < goals().size(); ++g)
      near.estimates.push_back(search_.combine_estimates(g, estimates[c]));
    const auto found = by_choice_.find(choices[c]);
    if (found != by_choice_.end()) near.trial = &trials_[found->second];
  }
  return all;
}

}  // namespace tools::optimise
