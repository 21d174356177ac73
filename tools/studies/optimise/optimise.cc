#include "tools/studies/optimise/optimise.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/host/process.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/optimise/answer.h"
#include "tools/studies/optimise/search_run.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::optimise {
namespace {

namespace fs = std::filesystem;
using sweep::Point;
using sweep::SweepFolder;

/// Applies command-line options to a search's task. They override the search's file.
void override_task(Task& task, const Options& options) {
  if (options.budget) task.budget = *options.budget;
  if (options.seed) task.seed = *options.seed;
  if (!options.fidelity.empty()) task.fidelity = parse_fidelity(options.fidelity).value_or(Fidelity::kAuto);
  if (options.confidence) task.confidence = *options.confidence;
  task.space.sets.insert(task.space.sets.end(), options.sets.begin(), options.sets.end());
}

/// Returns the command that repeats a search and simulates whole frames of its front.
std::string check_command(const Options& options, const fs::path& out) {
  std::vector<std::string> words = {"raywatt", "optimise", options.file.string(), "-o", out.string()};
  const auto add = [&](const char* option, const std::string& value) {
    words.emplace_back(option);
    words.push_back(value);
  };
  if (options.budget) add("--budget", fmt::format("{}", *options.budget));
  if (options.seed) add("--seed", fmt::format("{}", *options.seed));
  if (!options.fidelity.empty()) add("--fidelity", options.fidelity);
  if (options.confidence) add("--confidence", fmt::format("{}", *options.confidence));
  for (const std::string& set : options.sets) add("--set", set);
  if (!options.store.empty()) add("--store", options.store.string());
  words.emplace_back("--check");
  return command_text(words);
}

/// Removes the recorded rays of the points, unless another process is recording them.
void remove_streams(const std::vector<Point>& points, const sweep::Store& store) {
  std::set<std::string> streams;
  for (const Point& point : points) {
    if (!point.stream.empty()) streams.insert(point.stream);
  }
  for (const std::string& stream : streams) {
    if (const std::optional<sim::FileLock> lock = store.lock_stream(stream)) store.remove_stream(stream);
  }
}

/// Makes the answer of a finished search, with trades of the best machine and probabilities that it meets its limits.
Answer make_answer(SearchRun& search, const sweep::Store& store) {
  Answer answer{search};
  const Trial* const best = answer.best();
  if (best == nullptr) return answer;
  answer.trades = trades_of(search, *best);
  try {
    answer.odds = search.evaluator().limit_probabilities_of(*best, store);
  } catch (const sim::InputError& error) {
    answer.not_priced = error.what();
  }
  return answer;
}

}  // namespace

void check_task(const Options& options, Task task) {
  override_task(task, options);
  const SearchRun search(task, options.file.parent_path());
}

int run(const Options& options) { return run(options, read_task(options.file), sim::read_file(options.file, 1 << 20)); }

int run(const Options& options, Task task, const std::string& text,
        const std::function<void(const SearchRun& search)>& on_end) {
  check_options(options);
  override_task(task, options);
  SearchRun search(task, options.file.parent_path());
  const fs::path out = !options.out.empty()
                           ? options.out
                           : fs::path("raywatt-out") / fmt::format("optimise-{}", options.file.stem().string());
  const fs::path store_root = !options.store.empty() ? options.store : sweep::Store::default_root();
  const HoldInterrupts hold;
  const std::optional<sim::FileLock> lock = SweepFolder::try_claim(out, SweepFolder::FolderKind::kSearch);
  if (!lock)
    throw sim::InputError(fmt::format("{}: folder is locked by another process", sim::printable(out.string())));
  // Workers of an interrupted search may still run. Their points must stay in sweep.json.
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
  LauncherOptions how = options;
  how.keep_streams = true;  // rays are recorded once for all batches
  const std::unique_ptr<sweep::Launcher> launcher = make_launcher(how, folder);

  Progress progress(options.progress, options.quiet);
  progress.expect_parts(1, "optimise");
  progress.begin_part("simulating", 0, static_cast<std::uint32_t>(task.budget));
  const auto announce = [&](const std::vector<Point>& points) {
    write_points(points, former);
    progress.set_phase(fmt::format("{} of {} machines, {} on the front", search.simulated_count(), task.budget,
                                   search.pareto_front().size()));
    progress.set_tiles_done(static_cast<std::uint32_t>(search.simulated_count()), 0, 0);
  };
  const auto begin = sim::HostClock::now();
  const SearchRun::Hooks hooks{announce, [](std::size_t, PointStatus) {}};
  bool finished = search.run(*launcher, store, hooks);
  if (finished && options.check) {
    progress.set_phase("simulating whole frames of the front");
    finished = search.check_front(*launcher, store, hooks);
  }
  progress.finish(finished ? "done" : "interrupted");

  if (finished) {
    write_points(search.points(false), {});
    remove_streams(search.points(true), store);
  }
  sim::write_file_atomically(out / "history.jsonl", history_jsonl(search));
  sim::write_file_atomically(out / "front.csv", front_csv(search));
  set_interrupt_note(fmt::format("kept {} of {} machines; run the same command again to continue",
                                 search.simulated_count(), task.budget));
  if (!finished) return kGood;  // the destructor of `hold` ends the process
  if (on_end) on_end(search);

  Answer answer = make_answer(search, store);
  answer.seconds = sim::seconds_since(begin);
  answer.is_checked = options.check;
  if (!on_end) answer.check_command = check_command(options, out);
  sim::write_file_atomically(out / kSearchFile, sim::json_lines(search_json(answer)));
  const bool is_feasible = !search.pareto_front().empty();
  if (!options.quiet && options.prints_answer) {
    fmt::print("{}\n{}results: {}, history.jsonl\n", to_terminal_encoding(answer_text(answer)), summary_text(answer),
               (out / "front.csv").string());
  }
  for (const Trial& trial : search.trials()) {
    if (trial.status == PointStatus::kFailed && options.prints_answer)
      fmt::print("failed: {}\n", sim::printable(trial.error, 500));
  }
  return is_feasible && std::ranges::count(search.trials(), PointStatus::kFailed, &Trial::status) == 0 ? kGood
                                                                                                       : kCheckFailed;
}

}  // namespace tools::optimise
