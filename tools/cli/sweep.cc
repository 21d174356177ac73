#include <chrono>
#include <csignal>
#include <ctime>
#include <iterator>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/cli/job_options.h"
#include "tools/cli/launcher.h"
#include "tools/cli/sweep_slurm.h"
#include "tools/cli/verbs.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/studies/sweep/folder.h"
#include "tools/studies/sweep/local_launcher.h"
#include "tools/studies/sweep/plan.h"
#include "tools/studies/sweep/point_keys.h"
#include "tools/studies/sweep/results/collect.h"

namespace tools {

namespace {

namespace fs = std::filesystem;
using sweep::Fate;
using sweep::Point;
using sweep::Store;
using sweep::SweepFolder;

constexpr std::size_t kShownFailures = 20;

/// "12  cores=4, tni.trvs=2"
std::string name_of(const Point& point) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : point.axes) parts.push_back(name + "=" + value);
  return fmt::format("{:<5} {}", point.n, fmt::join(parts, ", "));
}

void print_failures(const Store& store, const std::vector<Point>& points) {
  std::size_t failed = 0;
  for (const Point& point : points) {
    const std::optional<sweep::Failure> failure = store.failure(point.id);
    if (!failure || store.state(point.id) == Store::State::kGood) continue;
    if (failed == 0) fmt::print("failed:\n");
    if (++failed <= kShownFailures) fmt::print("  {}: {}\n", name_of(point), sim::printable(failure->error, 500));
  }
  if (failed > kShownFailures) fmt::print("  and {} more\n", failed - kShownFailures);
}

struct RunOptions : LauncherOptions {
  fs::path file, out, store;
  bool wait = false, resume = false, dry_run = false, quiet = false;
  std::string progress = "auto";
};

struct Planned {
  std::string text;  ///< of the file
  std::vector<Point> points;
  std::vector<std::string> slurm;
};

Planned plan_from_file(const fs::path& file) {
  const sweep::Spec spec = sweep::read_spec(file);
  return {sim::read_file(file, 1 << 20), sweep::plan(spec, file.parent_path()), spec.slurm};
}

/// The points of a folder, with their keys of today.
Planned plan_from_folder(const SweepFolder& folder) {
  Planned planned{sim::read_file(folder.path() / "sweep.yaml", 1 << 20), folder.points(), folder.slurm()};
  sweep::PointKeys keys;
  for (Point& point : planned.points) keys.set_key(point);
  return planned;
}

void print_plan(const std::vector<Point>& points, const Store& store) {
  std::vector<std::string> header = {"n"};
  for (const auto& [name, value] : points.front().axes) header.push_back(name);
  header.emplace_back("state");
  sim::Table table(header);
  std::uint64_t there = 0, impossible = 0;
  for (const Point& point : points) {
    std::vector<std::string> cells = {std::to_string(point.n)};
    for (const auto& [name, value] : point.axes) cells.push_back(value);
    const bool is_there = store.state(point.id) == Store::State::kGood;
    there += is_there ? 1 : 0;
    impossible += point.error.empty() ? 0 : 1;
    cells.emplace_back(is_there ? "in the store" : point.error.empty() ? "to compute" : "impossible");
    table.row(std::move(cells));
  }
  fmt::print("{}\n{} points, {} of them in the store\n", table.text(), points.size(), there);
  for (const Point& point : points) {
    if (!point.error.empty()) fmt::print("impossible: {}: {}\n", name_of(point), sim::printable(point.error, 500));
  }
}

/// Tells how far a batch is.
class Watcher {
 public:
  Watcher(const RunOptions& options, std::size_t points)
      : progress_(options.progress, options.quiet), points_(static_cast<std::uint32_t>(points)) {
    progress_.expect(1, "sweep");
    progress_.begin_part(text(), 0, points_);
  }
  void operator()(Fate fate) {
    ended_ += 1;
    failed_ += fate == Fate::kFailed ? 1 : 0;
    progress_.phase(text());
    progress_.tiles_done(ended_, 0, 0);
  }
  void end(const std::string& how) { progress_.end(how); }

 private:
  std::string text() const {
    return fmt::format("{} of {} points{}", ended_, points_, failed_ != 0 ? fmt::format(", {} failed", failed_) : "");
  }

  Progress progress_;
  const std::uint32_t points_;
  std::uint32_t ended_ = 0, failed_ = 0;
};

int run(const RunOptions& options) {
  if (options.file.empty() && !(options.resume && !options.out.empty())) {
    throw sim::InputError("no sweep is named; allowed: raywatt sweep run FILE, or raywatt sweep run --resume -o DIR");
  }
  check(options);
  if (options.wait && options.launcher != "slurm") throw sim::InputError("--wait is for --launcher slurm");
  const bool from_file = !options.file.empty();
  const fs::path out = !options.out.empty()
                           ? options.out
                           : fs::path("raywatt-out") / fmt::format("sweep-{}", options.file.stem().string());
  std::optional<SweepFolder> former;
  if (options.resume) former = SweepFolder::open(out);
  const Planned planned = from_file ? plan_from_file(options.file) : plan_from_folder(*former);
  const fs::path store_root = !options.store.empty() ? options.store
                              : former               ? former->store().root()
                                                     : Store::default_root();
  if (options.dry_run) {
    print_plan(planned.points, Store(store_root));
    return kGood;
  }
  const HoldInterrupts hold;
  const std::optional<sweep::Lock> lock = SweepFolder::claim(out, SweepFolder::Of::kSweep);
  if (!lock) throw sim::InputError(fmt::format("{}: somebody is running this sweep", sim::printable(out.string())));
  const SweepFolder folder =
      SweepFolder::create(out, SweepFolder::Of::kSweep, planned.text, planned.points, store_root, planned.slurm);
  const Store store = folder.store();
  store.clean();
  const std::unique_ptr<sweep::Launcher> launcher = make_launcher(options, folder);
  if (auto* slurm = dynamic_cast<sweep::SlurmLauncher*>(launcher.get()); slurm != nullptr && !options.wait) {
    const sweep::SlurmLauncher::Submitted submitted = slurm->submit(planned.points);
    if (submitted.points + submitted.queued != 0) {
      if (!options.quiet) tell_submitted(submitted, planned.points.size(), out);
      return kGood;
    }
  }
  Watcher watcher(options, planned.points.size());
  const sweep::BatchEnd end = launcher->run(planned.points, [&](std::size_t, Fate fate) { watcher(fate); });
  watcher.end(end.interrupted ? "interrupted" : "done");
  const std::uint64_t computed = end.count(Fate::kComputed), found = end.count(Fate::kFound),
                      failed = end.count(Fate::kFailed), missing = end.count(Fate::kMissing);
  folder.note_run({{"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
                   {"host", sweep::host_name()},
                   {"points", planned.points.size()},
                   {"computed", computed},
                   {"found", found},
                   {"failed", failed},
                   {"seconds", end.seconds},
                   {"workers", end.workers},
                   {"busy", end.busy}});
  results::collect(folder);
  tell_if_interrupted(fmt::format("kept {} of {} points in {}", computed + found, planned.points.size(), out.string()));
  if (!options.quiet) {
    fmt::print("{} points: {} computed, {} found, {} failed{}\n", planned.points.size(), computed, found, failed,
               missing != 0 ? fmt::format(", {} missing", missing) : "");
    if (end.workers != 0) {
      fmt::print("time:    {:.1f} s, {} worker{} busy {:.1f} % of it\n", end.seconds, end.workers,
                 end.workers == 1 ? "" : "s", 100 * end.busy);
    }
    fmt::print("results: {}\n", (out / "results.csv").string());
  }
  if (failed != 0) print_failures(store, planned.points);
  if (missing != 0) tell_missing(folder, missing);
  return failed + missing != 0 ? kCheckFailed : kGood;
}

void add_sweep_run(CLI::App& group, int& exit) {
  CLI::App* verb =
      group.add_subcommand("run", "Compute all points of a sweep; those that are there are not computed again");
  const auto options = std::make_shared<RunOptions>();
  verb->add_option("file", options->file, "the sweep, a .yaml file (docs/sweeps.md)");
  verb->add_option("-o,--output", options->out, "folder of the sweep (default: raywatt-out/sweep-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, for any number of sweeps (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_flag("--wait", options->wait, "slurm: return when all points have ended");
  verb->add_flag("--resume", options->resume, "go on with the sweep in the folder; then FILE may be left out");
  verb->add_flag("--dry-run", options->dry_run, "list the points; compute nothing, write nothing");
  verb->add_flag("--quiet", options->quiet, "no summary, no bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command again goes on where it was stopped. Ends with 1, and a list, if points failed.\n\n"
      "Example: raywatt sweep run configs/experiments/trv-cores.yaml -o out/trv-cores -j 4");
  verb->callback([options, &exit] { exit = run(*options); });
}

struct PointOptions {
  fs::path folder, list;
  std::uint64_t index = 0, chunk = 1;
  std::uint32_t jobs = 1;
  bool retry_failed = false;
};

/// The ids of a list, by line, or of the sweep, each by itself, if there is none.
std::vector<std::vector<std::string>> listed(const std::vector<Point>& points, const fs::path& list) {
  std::vector<std::vector<std::string>> ids;
  if (list.empty()) {
    for (const Point& point : points) ids.push_back({point.id});
    return ids;
  }
  std::istringstream lines(sim::read_file(list, std::uint64_t{1} << 30));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    ids.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return ids;
}

/// The points of a chunk of lines.
std::vector<Point> chosen(const SweepFolder& folder, const PointOptions& options) {
  const std::vector<Point> all = folder.points();
  const std::vector<std::vector<std::string>> lines = listed(all, options.list);
  const std::uint64_t chunks = (lines.size() + options.chunk - 1) / options.chunk;
  if (options.index >= chunks) {
    throw sim::InputError(
        fmt::format("--index {}: there are {} chunks of {} points", options.index, chunks, options.chunk));
  }
  std::map<std::string, const Point*> by_id;
  for (const Point& point : all) by_id.emplace(point.id, &point);
  const std::size_t begin = options.index * options.chunk;
  const std::size_t end = begin + std::min<std::size_t>(options.chunk, lines.size() - begin);
  std::vector<Point> points;
  for (std::size_t l = begin; l < end; ++l) {
    for (const std::string& id : lines[l]) {
      const auto found = by_id.find(id);
      if (found == by_id.end()) {
        throw sim::InputError(fmt::format("{}:{}: '{}' is no point of this sweep",
                                          sim::printable(options.list.string()), l + 1, sim::printable(id)));
      }
      points.push_back(*found->second);
    }
  }
  return points;
}

int compute_listed(const PointOptions& options) {
  const SweepFolder folder = SweepFolder::open(options.folder);
  const std::vector<Point> points = chosen(folder, options);
  const HoldInterrupts hold;
  sweep::LocalLauncher launcher(folder.store(), {.jobs = options.jobs,
                                                 .threads = 1,
                                                 .retry_failed = options.retry_failed,
                                                 .keep_streams = true,
                                                 .log = folder.log()});
  const sweep::BatchEnd end = launcher.run(points);
  return end.count(Fate::kFailed) != 0 ? kCheckFailed : kGood;
}

void add_sweep_point(CLI::App& group, int& exit) {
  CLI::App* verb =
      group.add_subcommand("point", "Compute some points of a sweep: what launchers start on cluster nodes");
  const auto options = std::make_shared<PointOptions>();
  verb->add_option("folder", options->folder, "the sweep's folder")->required();
  verb->add_option("--list", options->list, "a file of ids, one or more a line (default: all points of the sweep)");
  verb->add_option("--index", options->index, "which chunk of its lines, from 0")->required();
  verb->add_option("-j,--jobs", options->jobs, "points at a time")->check(CLI::Range(1, 1024))->capture_default_str();
  verb->add_option("--chunk", options->chunk, "lines of a chunk")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_flag("--retry-failed", options->retry_failed, "points that failed are computed again");
  verb->footer(
      "Ends with 0 at once if the results are there, with 1 if a point fails.\n\n"
      "Example: raywatt sweep point out/l1 --list out/l1/submit-1.txt --index 7 --chunk 4");
  verb->callback([options, &exit] { exit = compute_listed(*options); });
}

/// How far a sweep is, from its folder and the store alone.
nlohmann::ordered_json status_of(const SweepFolder& folder) {
  const Store store = folder.store();
  std::uint64_t done = 0, failed = 0, running = 0, damaged = 0;
  const std::vector<Point> points = folder.points();
  nlohmann::ordered_json failures = nlohmann::ordered_json::array();
  for (const Point& point : points) {
    const Store::State state = store.state(point.id);
    if (state == Store::State::kGood) {
      done += 1;
    } else if (const std::optional<sweep::Failure> failure = store.failure(point.id)) {
      failed += 1;
      failures.push_back({{"n", point.n}, {"id", point.id}, {"exit", failure->exit}, {"error", failure->error}});
    } else {
      running += store.is_locked(point.id) ? 1 : 0;
      damaged += state == Store::State::kDamaged ? 1 : 0;
    }
  }
  const std::optional<SweepFolder::Runner> runner = folder.runner();
  return {{"points", points.size()},
          {"done", done},
          {"failed", failed},
          {"missing", points.size() - done - failed},
          {"running", running},
          {"damaged", damaged},
          {"runner", runner ? nlohmann::ordered_json{{"host", runner->host}, {"process", runner->process}}
                            : nlohmann::ordered_json(nullptr)},
          {"store", store.root().string()},
          {"failures", failures}};
}

void add_sweep_status(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("status", "How far a sweep is");
  const auto path = std::make_shared<fs::path>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt sweep status out/l1");
  verb->callback([=] {
    const SweepFolder folder = SweepFolder::open(*path);
    nlohmann::ordered_json status = status_of(folder);
    const std::optional<nlohmann::ordered_json> slurm = slurm_status(folder);
    if (slurm) status["slurm"] = *slurm;
    if (*json) {
      fmt::print("{}", sim::json_text(status));
      return;
    }
    const auto number = [&](const char* key) { return status[key].get<std::uint64_t>(); };
    fmt::print("{} points: {} done, {} failed, {} missing ({} of them being computed, {} damaged)\n", number("points"),
               number("done"), number("failed"), number("missing"), number("running"), number("damaged"));
    if (const std::optional<SweepFolder::Runner> runner = folder.runner()) {
      fmt::print("run by process {} on {}\n", runner->process, runner->host);
    }
    if (slurm) print_slurm_status(*slurm);
    fmt::print("store: {}\n", folder.store().root().string());
    print_failures(folder.store(), folder.points());
  });
}

void cancel(const fs::path& path) {
  constexpr auto kGlance = std::chrono::milliseconds(20);
  constexpr int kGlances = 1000;
  const SweepFolder folder = SweepFolder::open(path);
  const std::optional<SweepFolder::Runner> runner = folder.runner();
  const bool is_here = runner && runner->host == sweep::host_name() && runner->process > 1;
  if (is_here) {
    ::kill(runner->process, SIGTERM);
    for (int k = 0; k < kGlances && folder.runner(); ++k) std::this_thread::sleep_for(kGlance);
    if (folder.runner()) throw sim::IoError(fmt::format("process {} does not end", runner->process));
  }
  const bool had_jobs =
      cancel_on_slurm(folder);  // without them, a process elsewhere that waits for them ends by itself
  if (runner && !is_here && !had_jobs) {
    throw sim::InputError(fmt::format("{}: is run by process {} on {}; cancel it there", sim::printable(path.string()),
                                      runner->process, sim::printable(runner->host)));
  }
  if (!runner && !had_jobs) {
    fmt::print("nobody is running this sweep\n");
    return;
  }
  fmt::print("cancelled; what is finished is kept. Go on with: raywatt sweep run --resume -o {}\n", path.string());
}

void add_sweep_cancel(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("cancel", "Stop whoever runs a sweep, and its jobs; what is finished is kept");
  const auto path = std::make_shared<fs::path>();
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->footer("Example: raywatt sweep cancel out/l1");
  verb->callback([=] { cancel(*path); });
}

}  // namespace

void add_sweep(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("sweep", "Many runs: axes, conditions, subsets; nothing is computed twice");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt sweep run configs/experiments/trv-cores.yaml -o out/trv-cores");
  add_sweep_run(*verb, exit);
  add_sweep_point(*verb, exit);
  add_sweep_status(*verb);
  add_sweep_cancel(*verb);
  add_sweep_results(*verb);
}

}  // namespace tools
