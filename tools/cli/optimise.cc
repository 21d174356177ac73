#include <algorithm>
#include <filesystem>
#include <iterator>
#include <memory>
#include <optional>
#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/cli/job_options.h"
#include "tools/cli/launcher.h"
#include "tools/cli/verbs.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/optimise/show.h"
#include "tools/studies/sweep/folder.h"

namespace tools {

namespace {

namespace fs = std::filesystem;
using optimise::Course;
using optimise::Trial;
using sweep::Point;
using sweep::SweepFolder;

struct Options : LauncherOptions {
  fs::path file, out, store;
  std::optional<std::uint64_t> budget, seed;
  std::string fidelity;
  bool quiet = false;
  std::string progress = "auto";
};

optimise::Task task_of(const Options& options) {
  optimise::Task task = optimise::read_task(options.file);
  if (options.budget) task.budget = *options.budget;
  if (options.seed) task.seed = *options.seed;
  if (!options.fidelity.empty()) task.sampled = options.fidelity == "sampled";
  return task;
}

std::uint64_t count(const Course& course, Trial::State state) {
  return static_cast<std::uint64_t>(std::ranges::count(course.trials(), state, &Trial::state));
}

std::string summary(const Course& course) {
  const auto looks = std::ranges::count_if(
      course.trials(), [](const Trial& trial) { return trial.is_look && trial.state != Trial::State::kImpossible; });
  const std::uint64_t failed = count(course, Trial::State::kFailed),
                      impossible = count(course, Trial::State::kImpossible);
  std::string text = fmt::format("{} points simulated", course.simulated());
  if (looks != 0) text += fmt::format(" after {} first looks", looks);
  text += fmt::format(": {} computed now, {} found in the store", course.computed(), course.found());
  if (failed != 0) text += fmt::format(", {} failed", failed);
  if (impossible != 0) text += fmt::format(", {} impossible", impossible);
  return text + "\n";
}

int run(const Options& options) {
  check(options);
  const optimise::Task task = task_of(options);
  Course course(task, options.file.parent_path());
  const fs::path out = !options.out.empty()
                           ? options.out
                           : fs::path("raywatt-out") / fmt::format("optimise-{}", options.file.stem().string());
  const fs::path store_root = !options.store.empty() ? options.store : sweep::Store::default_root();
  const std::string text = sim::read_file(options.file, 1 << 20);
  const HoldInterrupts hold;
  const std::optional<sweep::Lock> lock = SweepFolder::claim(out, SweepFolder::Of::kSearch);
  if (!lock) throw sim::InputError(fmt::format("{}: somebody is working in this folder", sim::printable(out.string())));
  // Tasks of an interrupted search that are still under way find their points here.
  std::vector<Point> former;
  if (fs::exists(out / "sweep.json")) former = SweepFolder::open(out).points();
  const auto write_points = [&](std::vector<Point> points, const std::vector<Point>& others) {
    std::set<std::string> ids;
    for (const Point& point : points) ids.insert(point.id);
    std::ranges::copy_if(others, std::back_inserter(points), [&](const Point& p) { return ids.insert(p.id).second; });
    for (std::size_t n = 0; n < points.size(); ++n) points[n].n = n;
    return SweepFolder::create(out, SweepFolder::Of::kSearch, text, points, store_root, task.space.slurm);
  };
  const SweepFolder folder = write_points({}, former);
  const sweep::Store store = folder.store();
  store.clean();
  const std::unique_ptr<sweep::Launcher> launcher = make_launcher(options, folder);

  Progress progress(options.progress, options.quiet);
  progress.expect(1, "optimise");
  progress.begin_part("simulating", 0, static_cast<std::uint32_t>(task.budget));
  const auto announce = [&](const std::vector<Point>& points) {
    write_points(points, former);
    progress.phase(
        fmt::format("{} of {} simulations, {} on the front", course.simulated(), task.budget, course.front().size()));
    progress.tiles_done(static_cast<std::uint32_t>(course.simulated()), 0, 0);
  };
  const bool finished = course.run(*launcher, store, {announce, [](std::size_t, sweep::Fate) {}});
  progress.end(finished ? "done" : "interrupted");

  std::vector<Point> simulated;
  for (const Trial& trial : course.trials()) {
    if (!trial.is_look && trial.state != Trial::State::kImpossible) simulated.push_back(trial.point);
  }
  if (finished) write_points(simulated, {});
  sim::write_file_atomically(out / "history.jsonl", optimise::history_jsonl(course));
  sim::write_file_atomically(out / "front.csv", optimise::front_csv(course));
  tell_if_interrupted(
      fmt::format("kept {} of {} simulations; the same command goes on", course.simulated(), task.budget));
  if (!finished) return kGood;  // the end of `hold` ends the process

  const bool is_feasible = !course.front().empty();
  if (!options.quiet) {
    fmt::print("{}\n{}results: {}, history.jsonl\n",
               is_feasible ? optimise::front_text(course) : optimise::infeasible_text(course), summary(course),
               (out / "front.csv").string());
  }
  for (const Trial& trial : course.trials()) {
    if (trial.state == Trial::State::kFailed) fmt::print("failed: {}\n", sim::printable(trial.error, 500));
  }
  return is_feasible && count(course, Trial::State::kFailed) == 0 ? kGood : kCheckFailed;
}

}  // namespace

void add_optimise(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("optimise", "Search a space for its best points in one or two figures");
  verb->alias("optimize");
  const auto options = std::make_shared<Options>();
  verb->add_option("file", options->file, "the space and what is asked of it, a .yaml file (docs/optimise.md)")
      ->required();
  verb->add_option("-o,--output", options->out, "folder (default: raywatt-out/optimise-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, the sweeps' (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_option("--budget", options->budget, "different points that are simulated (default: the file's, or 100)")
      ->check(CLI::Range(optimise::kLeastBudget, optimise::kMostBudget));
  verb->add_option("--seed", options->seed, "of all that is drawn (default: the file's, or 1)");
  verb->add_option("--fidelity", options->fidelity, "sampled: first looks by tile sampling (default: the file's)")
      ->check(CLI::IsMember({"full", "sampled"}));
  verb->add_flag("--quiet", options->quiet, "no table, no bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command again goes on where it was stopped. Ends with 1 if no point meets the constraints, or points "
      "failed.\n\n"
      "Example: raywatt optimise configs/experiments/optimise-cores.yaml -o out/best -j 4");
  verb->callback([options, &exit] { exit = run(*options); });
}

}  // namespace tools
