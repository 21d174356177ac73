#include "tools/studies/optimise/optimise.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/optimise/show.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools::optimise {
namespace {

namespace fs = std::filesystem;
using sweep::Point;
using sweep::SweepFolder;

Task task_of(const Options& options) {
  Task task = read_task(options.file);
  if (options.budget) task.budget = *options.budget;
  if (options.seed) task.seed = *options.seed;
  if (!options.fidelity.empty()) task.sampled = options.fidelity == "sampled";
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
  const std::optional<sim::FileLock> lock = SweepFolder::try_claim(out, SweepFolder::Of::kSearch);
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
    return SweepFolder::create(out, SweepFolder::Of::kSearch, text, points, store_root, task.space.slurm);
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
    const std::string found = terminal_text(is_feasible ? pareto_front_text(search) : infeasible_text(search));
    fmt::print("{}\n{}results: {}, history.jsonl\n", found, summary_text(search), (out / "front.csv").string());
  }
  for (const Trial& trial : search.trials()) {
    if (trial.status == PointStatus::kFailed) fmt::print("failed: {}\n", sim::printable(trial.error, 500));
  }
  return is_feasible && count_trials(search, PointStatus::kFailed) == 0 ? kGood : kCheckFailed;
}

}  // namespace tools::optimise
