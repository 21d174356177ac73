#include "tools/studies/optimise/optimise.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/analysis/report_file.h"
#include "tools/host/process.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::optimise {
namespace {

namespace fs = std::filesystem;
using sim::Json;
using sweep::Point;
using sweep::SweepFolder;

constexpr double kError = 0.05;  // family-wise error: probability that a point equal to the front is left out

/// Compares two points under noise.
class Comparator {
 public:
  explicit Comparator(const SearchRun& search) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      most_.push_back(search.goals()[g].kind == Goal::Kind::kMax);
    }
  }
  std::size_t objective_count() const { return most_.size(); }
  /// True if the metric of `a` is better, noise ignored.
  bool is_better(const Trial& a, const Trial& b, std::size_t objective) const {
    return most_[objective] ? a.metrics[objective] > b.metrics[objective] : a.metrics[objective] < b.metrics[objective];
  }
  /// Returns the p-value of "`a` is better than `b`" under the null hypothesis that it is not.
  double p_value(const Trial& a, const Trial& b, std::size_t objective) const {
    MeanDifference d = difference_of(b.seen[objective], a.seen[objective]);
    if (!most_[objective]) d.value = -d.value;
    return d.one_sided_p_value();
  }
  /// True if trial `a` is significantly better than `b` (p <= `level`) in each noisy objective, and equal or better in
  /// each exact objective.
  bool dominates_beyond_noise(const Trial& a, const Trial& b, double level) const {
    bool differs = false;
    for (std::size_t o = 0; o < objective_count(); ++o) {
      const bool is_better = p_value(a, b, o) <= level;
      const bool is_equal =
          a.seen[o].standard_error() == 0 && b.seen[o].standard_error() == 0 && a.metrics[o] == b.metrics[o];
      if (!is_better && !is_equal) return false;
      differs = differs || is_better;
    }
    return differs;
  }

 private:
  std::vector<bool> most_;
};

std::vector<const Trial*> ties_with(const Trial& first, const std::vector<const Trial*>& others,
                                    const Comparator& comparator) {
  std::vector<double> chances;
  for (const Trial* other : others) chances.push_back(comparator.p_value(first, *other, 0));
  const std::vector<bool> worse = reject_hypotheses(chances, kError);
  std::vector<const Trial*> ties;
  for (std::size_t i = 0; i < others.size(); ++i) {
    if (!worse[i]) ties.push_back(others[i]);
  }
  return ties;
}

/// Returns feasible points off the front that equal it within noise, the best in the first objective first. One
/// objective: points that a one-sided test does not find worse than the best (Holm, 5 % family-wise error). Two: points
/// that no other dominates by more than the noise (Bonferroni).
std::vector<const Trial*> near_front(const SearchRun& search) {
  const Comparator comparator(search);
  const std::vector<const Trial*> all = search.feasible_trials(), front = search.pareto_front();
  if (front.empty()) return {};
  std::vector<const Trial*> others, near;
  std::ranges::copy_if(all, std::back_inserter(others),
                       [&](const Trial* t) { return std::ranges::find(front, t) == front.end(); });
  if (comparator.objective_count() == 1) {
    near = ties_with(*front.front(), others, comparator);
  } else {
    const double level = kError / static_cast<double>(all.size());
    std::ranges::copy_if(others, std::back_inserter(near), [&](const Trial* other) {
      return std::ranges::none_of(all,
                                  [&](const Trial* t) { return comparator.dominates_beyond_noise(*t, *other, level); });
    });
  }
  std::ranges::stable_sort(near, [&](const Trial* a, const Trial* b) { return comparator.is_better(*a, *b, 0); });
  return near;
}

/// Names the source of the noise of the objectives: "noise measured by 5 replicates a point"; empty without noise.
std::string noise_text(const SearchRun& search) {
  std::vector<std::string> parts, shares, assumed;
  const auto add = [](std::vector<std::string>& all, std::string text) {
    if (std::ranges::find(all, text) == all.end()) all.push_back(std::move(text));
  };
  for (const Trial* trial : search.feasible_trials()) {
    for (std::size_t g = 0; g < search.goals().size() && search.goals()[g].is_objective(); ++g) {
      const MeasuredFigure& seen = trial->seen[g];
      if (seen.draws) add(parts, fmt::format("noise measured by {} replicates per point", seen.draws->count));
      if (seen.assumed <= 0) continue;
      const std::string share = fmt::format("{:.2g} %", 100 * seen.assumed);
      add(shares, share);
      add(assumed, fmt::format("{} of {}", share, search.goals()[g].metric));
    }
  }
  if (!assumed.empty()) {
    parts.push_back(fmt::format("noise of {} is assumed; set `replicates:` in the search file to measure it",
                                shares.size() == 1 ? shares.front() : fmt::format("{}", fmt::join(assumed, " and "))));
  }
  return fmt::format("{}", fmt::join(parts, "; "));
}

constexpr std::size_t kMostCommands = 20, kMostNear = 20,
                      kMostNamed = 20;  // points listed in the terminal; files list all

std::string command_of(const Trial& trial) { return command_text(trial.point.run_options().argv); }

/// Returns the indices of the goals to show as columns: one goal for each metric.
std::vector<std::size_t> shown_goals(const SearchRun& search) {
  std::vector<std::size_t> shown;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const auto is_same = [&](std::size_t s) { return search.goals()[s].metric == search.goals()[g].metric; };
    if (std::ranges::none_of(shown, is_same)) shown.push_back(g);
  }
  return shown;
}

std::string goals_text(const SearchRun& search) {
  std::vector<std::string> objectives, constraints;
  for (const Goal& goal : search.goals()) (goal.is_objective() ? objectives : constraints).push_back(goal.text());
  return fmt::format("{}{}{}", fmt::join(objectives, ", "), constraints.empty() ? "" : " with ",
                     fmt::join(constraints, ", "));
}

/// Returns the number of a point: the index of its line in history.jsonl, from 0.
std::size_t number_of(const SearchRun& search, const Trial& trial) {
  return static_cast<std::size_t>(&trial - search.trials().data());
}

/// Returns the simulated points that have metrics.
std::vector<const Trial*> done_trials(const SearchRun& search) {
  std::vector<const Trial*> all;
  for (const Trial& trial : search.trials()) {
    if (trial.status == PointStatus::kDone && !trial.is_look) all.push_back(&trial);
  }
  return all;
}

/// Returns how many points meet each constraint: "perf.fps >= 60: 20, power_w.nominal < 1: 25".
std::string met_text(const SearchRun& search) {
  const std::vector<const Trial*> all = done_trials(search);
  std::vector<std::string> each;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (goal.is_objective()) continue;
    const auto met = std::ranges::count_if(all, [&](const Trial* t) { return goal.is_met(t->metrics[g]); });
    each.push_back(fmt::format("{}: {}", goal.text(), met));
  }
  return fmt::format("{}", fmt::join(each, ", "));
}

/// Returns how many points are feasible; empty without constraints.
std::string feasible_text(const SearchRun& search) {
  const std::string met = met_text(search);
  if (met.empty()) return "";
  return fmt::format("{} of {} points meet all constraints ({})\n", search.feasible_trials().size(),
                     done_trials(search).size(), met);
}

/// Lists points whose distance from a limit is less than half of the 95 % interval of the metric.
std::string doubtful_text(const SearchRun& search, const std::vector<const Trial*>& trials) {
  std::string text;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (goal.is_objective()) continue;
    std::vector<std::size_t> points;
    for (const Trial* trial : trials) {
      if (std::abs(trial->metrics[g] - goal.limit) < trial->seen[g].half_width()) {
        points.push_back(number_of(search, *trial));
      }
    }
    if (points.empty()) continue;
    text += fmt::format("within the noise of the limit {}: {} {}\n", goal.text(),
                        points.size() == 1 ? "point" : "points", fmt::join(points, ", "));
  }
  return text;
}

/// Lists the extrapolated metrics of the points in `answer`, then the other points that have extrapolated metrics.
std::string extrapolations_text(const SearchRun& search, const std::vector<const Trial*>& answer) {
  std::map<std::string, std::vector<std::size_t>> lines;
  for (const Trial* trial : answer) {
    for (const std::string& line : trial->extrapolations) lines[line].push_back(number_of(search, *trial));
  }
  std::string text;
  for (const auto& [line, points] : lines) {
    text += fmt::format("warning: {} {}: {}\n", points.size() == 1 ? "point" : "points", fmt::join(points, ", "),
                        sim::printable(line, 500));
  }
  std::vector<std::size_t> others;
  for (const Trial* trial : done_trials(search)) {
    if (!trial->extrapolations.empty() && std::ranges::find(answer, trial) == answer.end()) {
      others.push_back(number_of(search, *trial));
    }
  }
  if (others.empty()) return text;
  const std::size_t all = others.size();
  others.resize(std::min(all, kMostNamed));
  return text + fmt::format("{}points with extrapolated figures, which warnings[] of their reports name: {}{}\n",
                            lines.empty() ? "" : "more ", fmt::join(others, ", "),
                            all > others.size() ? fmt::format(" and {} more", all - others.size()) : "");
}

/// Returns a table of points with half of the 95 % interval of each noisy metric and the distance to its limits.
std::string table_text(const SearchRun& search, const std::vector<const Trial*>& trials) {
  const std::vector<std::size_t> goals = shown_goals(search);
  std::vector<std::string> header = {"n"};
  for (const auto& [name, value] : trials.front()->point.axes) header.push_back(sim::printable(name));
  std::vector<std::vector<std::string>> columns;
  for (const std::size_t g : goals) {
    header.push_back(metric_name(search.goals()[g].metric));
    std::vector<results::Value> values;
    for (const Trial* trial : trials) values.emplace_back(trial->metrics[g]);
    columns.push_back(results::shown_cells(values));
    if (std::ranges::any_of(trials, [&](const Trial* t) { return t->seen[g].standard_error() > 0; })) {
      header.emplace_back("95 %");
      std::vector<std::string>& intervals = columns.emplace_back();
      for (const Trial* trial : trials) {
        const MeasuredFigure& seen = trial->seen[g];
        const double share = seen.value == 0 ? 0 : seen.half_width() / std::abs(seen.value);
        intervals.push_back(fmt::format("± {:.2g} %", 100 * share));
      }
    }
    for (const Goal& goal : search.goals()) {
      if (goal.is_objective() || goal.metric != search.goals()[g].metric) continue;
      header.push_back(goal.distance_title());
      std::vector<std::string>& distances = columns.emplace_back();
      for (const Trial* trial : trials) distances.push_back(goal.distance_text(trial->metrics[g]));
    }
  }
  sim::Table table(header);
  for (std::size_t t = 0; t < trials.size(); ++t) {
    std::vector<std::string> cells = {std::to_string(number_of(search, *trials[t]))};
    for (const auto& [name, value] : trials[t]->point.axes) cells.push_back(sim::printable(value));
    for (const std::vector<std::string>& column : columns) cells.push_back(column[t]);
    table.add_row(std::move(cells));
  }
  return table.text();
}

/// Lists points that are equal to the front within noise, and names the source of the noise.
std::string near_text(const SearchRun& search) {
  const std::string noise = noise_text(search);
  if (noise.empty()) return "";
  std::vector<const Trial*> near = near_front(search);
  const char* const what = std::ranges::count_if(search.goals(), &Goal::is_objective) == 1 ? "the best" : "the front";
  if (near.empty()) return fmt::format("\nall other points differ from {} by more than noise; {}\n", what, noise);
  std::string text = fmt::format("\n{} more point{} equal{} {} within noise; {}\n", near.size(),
                                 near.size() == 1 ? "" : "s", near.size() == 1 ? "s" : "", what, noise);
  const std::size_t all = near.size();
  near.resize(std::min(all, kMostNear));
  text += "\n" + table_text(search, near);
  return text + (all > near.size() ? fmt::format("and {} more in history.jsonl\n", all - near.size()) : "");
}

/// Returns the Pareto front, or the best point, as a table, and the commands that rerun its points.
std::string pareto_front_text(const SearchRun& search) {
  const std::vector<const Trial*> front = search.pareto_front();
  std::string text = front.size() == 1 ? "best: " : "front of ";
  text += fmt::format("{}\n{}\n{}", goals_text(search), feasible_text(search), table_text(search, front));
  for (const std::string& more :
       {doubtful_text(search, front), extrapolations_text(search, front), near_text(search)}) {
    if (!more.empty()) text += more.front() == '\n' ? more : "\n" + more;
  }
  text += "\ncommands:\n";
  for (std::size_t i = 0; i < std::min(front.size(), kMostCommands); ++i) {
    text += fmt::format("  {:<4} {}\n", number_of(search, *front[i]), sim::printable(command_of(*front[i]), 4096));
  }
  if (front.size() > kMostCommands) text += fmt::format("  and {} more in front.csv\n", front.size() - kMostCommands);
  return text;
}

/// Returns the Pareto front with all digits: axes, metrics, command.
std::string pareto_front_csv(const SearchRun& search) {
  std::vector<std::string> names = {"n", "id"};
  const std::vector<const Trial*> front = search.pareto_front();
  for (const Trial* trial : {front.empty() ? nullptr : front.front()}) {
    if (trial == nullptr) continue;
    for (const auto& [name, value] : trial->point.axes) names.push_back(name);
  }
  for (const std::size_t g : shown_goals(search)) names.push_back(search.goals()[g].metric);
  names.emplace_back("command");
  std::string text = results::csv_line(names);
  for (const Trial* trial : front) {
    std::vector<std::string> cells = {std::to_string(number_of(search, *trial)), trial->point.id};
    for (const auto& [name, value] : trial->point.axes) cells.push_back(value);
    for (const std::size_t g : shown_goals(search)) cells.push_back(fmt::format("{}", trial->metrics[g]));
    cells.push_back(command_of(*trial));
    text += results::csv_line(cells);
  }
  return text;
}

/// Returns a line of JSON per point in the order of the search.
std::string history_jsonl(const SearchRun& search) {
  std::string text;
  for (const Trial& trial : search.trials()) {
    Json line = {{"n", number_of(search, trial)},
                 {"batch", trial.batch},
                 {"id", trial.point.id},
                 {"state", name_of(trial.status)}};
    if (trial.is_look) line["look"] = true;
    line["axes"] = Json::object();
    for (const auto& [name, value] : trial.point.axes) line["axes"][name] = value;
    if (!trial.metrics.empty()) {
      line["feasible"] = trial.is_feasible;
      for (const std::size_t g : shown_goals(search)) line["figures"][search.goals()[g].metric] = trial.metrics[g];
    }
    if (!trial.error.empty()) line["error"] = trial.error;
    text += sim::json_line(line) + "\n";
  }
  return text;
}

/// Explains why no point is feasible.
std::string infeasible_text(const SearchRun& search) {
  const Trial* nearest = search.least_infeasible();
  if (nearest == nullptr) return "no point could be simulated; history.jsonl has the reasons\n";
  std::vector<std::string> missed;
  for (std::size_t g = 0; g < search.goals().size(); ++g) {
    const Goal& goal = search.goals()[g];
    if (!goal.is_met(nearest->metrics[g])) {
      missed.push_back(fmt::format("{:.4g} where {} is required (room {})", nearest->metrics[g], goal.text(),
                                   goal.distance_text(nearest->metrics[g])));
    }
  }
  std::vector<std::string> axes;
  for (const auto& [name, value] : nearest->point.axes) axes.push_back(sim::printable(name + "=" + value));
  return fmt::format(
      "none of {} points meets the constraints; the nearest is {} ({}), with {}\npoints that meet {}\n{}",
      search.simulated_count(), number_of(search, *nearest), fmt::join(axes, ", "), fmt::join(missed, ", "),
      met_text(search), extrapolations_text(search, {nearest}));
}

Task task_of(const Options& options) {
  Task task = read_task(options.file);
  if (options.budget) task.budget = *options.budget;
  if (options.seed) task.seed = *options.seed;
  if (!options.fidelity.empty()) task.sampled = options.fidelity == "sampled";
  task.space.sets.insert(task.space.sets.end(), options.sets.begin(), options.sets.end());
  return task;
}

std::uint64_t count_trials(const SearchRun& search, PointStatus state) {
  return static_cast<std::uint64_t>(std::ranges::count(search.trials(), state, &Trial::status));
}

std::string summary_text(const SearchRun& search) {
  const auto looks = std::ranges::count_if(
      search.trials(), [](const Trial& trial) { return trial.is_look && trial.status != PointStatus::kImpossible; });
  const std::uint64_t failed = count_trials(search, PointStatus::kFailed),
                      impossible = count_trials(search, PointStatus::kImpossible);
  std::string text = fmt::format("{} points simulated", search.simulated_count());
  if (looks != 0) text += fmt::format(" after {} first looks", looks);
  text += fmt::format(": {} computed now, {} found in the store", search.computed_count(), search.found_count());
  if (failed != 0) text += fmt::format(", {} failed", failed);
  if (impossible != 0) text += fmt::format(", {} impossible", impossible);
  return text + "\n";
}

}  // namespace

int run(const Options& options) {
  check_options(options);
  const Task task = task_of(options);
  SearchRun search(task, options.file.parent_path());
  const fs::path out = !options.out.empty()
                           ? options.out
                           : fs::path("raywatt-out") / fmt::format("optimise-{}", options.file.stem().string());
  const fs::path store_root = !options.store.empty() ? options.store : sweep::Store::default_root();
  const std::string text = sim::read_file(options.file, 1 << 20);
  const HoldInterrupts hold;
  const std::optional<sim::FileLock> lock = SweepFolder::try_claim(out, SweepFolder::FolderKind::kSearch);
  if (!lock)
    throw sim::InputError(fmt::format("{}: folder is locked by another process", sim::printable(out.string())));
  // Workers of an interrupted search that still run find their points in sweep.json.
  std::vector<Point> former;
  if (fs::exists(out / "sweep.json")) former = SweepFolder::open(out).read_points();
  const auto write_points = [&](std::vector<Point> points, const std::vector<Point>& others) {
    std::set<std::string> ids;
    for (const Point& point : points) ids.insert(point.id);
    std::ranges::copy_if(others, std::back_inserter(points), [&](const Point& p) { return ids.insert(p.id).second; });
    for (std::size_t n = 0; n < points.size(); ++n) points[n].n = n;
    return SweepFolder::create(out, SweepFolder::FolderKind::kSearch, text, points, store_root, task.space.slurm);
  };
  const SweepFolder folder = write_points({}, former);
  const sweep::Store store = folder.store();
  store.remove_stale();
  const std::unique_ptr<sweep::Launcher> launcher = make_launcher(options, folder);

  Progress progress(options.progress, options.quiet);
  progress.expect_parts(1, "optimise");
  progress.begin_part("simulating", 0, static_cast<std::uint32_t>(task.budget));
  const auto announce = [&](const std::vector<Point>& points) {
    write_points(points, former);
    progress.set_phase(fmt::format("{} of {} simulations, {} on the front", search.simulated_count(), task.budget,
                                   search.pareto_front().size()));
    progress.set_tiles_done(static_cast<std::uint32_t>(search.simulated_count()), 0, 0);
  };
  const bool finished = search.run(*launcher, store, {announce, [](std::size_t, PointStatus) {}});
  progress.finish(finished ? "done" : "interrupted");

  std::vector<Point> simulated;
  for (const Trial& trial : search.trials()) {
    if (!trial.is_look && trial.status != PointStatus::kImpossible) simulated.push_back(trial.point);
  }
  if (finished) write_points(simulated, {});
  sim::write_file_atomically(out / "history.jsonl", history_jsonl(search));
  sim::write_file_atomically(out / "front.csv", pareto_front_csv(search));
  set_interrupt_note(fmt::format("kept {} of {} simulations; run the same command again to continue",
                                 search.simulated_count(), task.budget));
  if (!finished) return kGood;  // the destructor of `hold` ends the process

  const bool is_feasible = !search.pareto_front().empty();
  if (!options.quiet) {
    const std::string found = to_terminal_encoding(is_feasible ? pareto_front_text(search) : infeasible_text(search));
    fmt::print("{}\n{}results: {}, history.jsonl\n", found, summary_text(search), (out / "front.csv").string());
  }
  for (const Trial& trial : search.trials()) {
    if (trial.status == PointStatus::kFailed) fmt::print("failed: {}\n", sim::printable(trial.error, 500));
  }
  return is_feasible && count_trials(search, PointStatus::kFailed) == 0 ? kGood : kCheckFailed;
}

}  // namespace tools::optimise
