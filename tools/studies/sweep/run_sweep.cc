#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <iterator>
#include <map>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/process.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/launch/slurm.h"
#include "tools/studies/sweep/results/collect.h"
#include "tools/studies/sweep/spec/plan.h"
#include "tools/studies/sweep/sweep.h"

namespace tools {
namespace {

namespace fs = std::filesystem;
using sweep::Point;
using sweep::PointStatus;
using sweep::Store;
using sweep::SweepFolder;

constexpr std::size_t kShownFailures = 20;

/// Returns number and axis values of a point as text: "12  cores=4, tni.trvs=2".
std::string label_of(const Point& point) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : point.axes) parts.push_back(name + "=" + value);
  return fmt::format("{:<5} {}", point.n, fmt::join(parts, ", "));
}

struct Planned {
  std::string text;  ///< contents of the sweep's file
  std::vector<Point> points;
  std::vector<std::string> slurm;
};

/// Plans the points of a sweep's file. File names in it are relative to its folder. `sets`: settings of the command
/// line.
Planned plan_from_file(const SweepOptions& options, const fs::path& file, const std::vector<std::string>& sets) {
  sweep::Spec spec = sweep::read_spec(file);
  spec.sets.insert(spec.sets.end(), sets.begin(), sets.end());
  Progress progress(options.progress == "json" ? "none" : options.progress, options.quiet);
  progress.expect_parts(1, "sweep");
  progress.set_phase("choosing points");
  const auto tell = [&](std::size_t points, std::size_t of) {
    if (points == 1) progress.begin_part("planning", 0, static_cast<std::uint32_t>(of));
    progress.set_tiles_done(static_cast<std::uint32_t>(points), 0, 0);
  };
  return {sim::read_file(file, 1 << 20), sweep::plan_points(spec, file.parent_path(), tell), spec.slurm};
}

/// Reads the points of a sweep's folder and updates their ids. If a killed run has stored none, plans them again.
Planned plan_from_folder(const SweepOptions& options, const SweepFolder& folder) {
  const fs::path file = folder.path() / "sweep.yaml";
  Planned planned{sim::read_file(file, 1 << 20), folder.read_points(), folder.slurm_arguments()};
  if (planned.points.empty()) return plan_from_file(options, file, folder.sets());
  sweep::PointKeys keys;
  for (Point& point : planned.points) keys.set_key(point);
  return planned;
}

/// Returns the status of a point in a plan: "in the store", "impossible" or "to compute, 3 of 8 slices in the store".
std::string plan_status_text(const Point& point, const Store& store) {
  const auto is_there = [&](const Point& one) { return store.is_done(one.id); };
  if (is_there(point)) return "in the store";
  if (!point.error.empty()) return "impossible";
  if (!point.is_cut()) return "to compute";
  return fmt::format("to compute, {} of {} slices in the store", std::ranges::count_if(slices_of(point), is_there),
                     point.slices);
}

void print_plan(const std::vector<Point>& points, const Store& store) {
  std::vector<std::string> header = {"n"};
  for (const auto& [name, value] : points.front().axes) header.push_back(name);
  header.emplace_back("state");
  sim::Table table(header);
  std::uint64_t there = 0;
  for (const Point& point : points) {
    std::vector<std::string> cells = {std::to_string(point.n)};
    for (const auto& [name, value] : point.axes) cells.push_back(value);
    cells.push_back(plan_status_text(point, store));
    there += cells.back() == "in the store" ? 1 : 0;
    table.add_row(std::move(cells));
  }
  fmt::print("{}\n{} points, {} of them in the store\n", table.text(), points.size(), there);
  for (const Point& point : points) {
    if (!point.error.empty()) fmt::print("impossible: {}: {}\n", label_of(point), sim::printable(point.error, 500));
  }
}

/// Shows the progress of a batch. Counts points, or for points that are cut, their slices.
class BatchProgress {
 public:
  BatchProgress(const SweepOptions& options, const std::vector<Point>& points)
      : progress_(options.progress, options.quiet), points_(points), slices_(points.size()) {
    for (const Point& point : points) all_ += point.piece_count();
    progress_.expect_parts(1, "sweep");
    progress_.begin_part(text(), 0, all_);
  }
  void count_slice(std::size_t p) {
    slices_[p] += 1;
    show_progress(1);
  }
  void count_point(std::size_t p, PointStatus status) {
    ended_ += 1;
    failed_ += status == PointStatus::kFailed ? 1 : 0;
    show_progress(points_[p].piece_count() - slices_[p]);
  }
  void end(const std::string& how) { progress_.finish(how); }

 private:
  void show_progress(std::uint32_t more) {
    done_ += more;
    progress_.set_phase(text());
    progress_.set_tiles_done(done_, 0, 0);
  }
  std::string text() const {
    const std::size_t all = points_.size();
    return fmt::format("{} of {} points{}{}", ended_, all,
                       all_ != all ? fmt::format(", {} of {} slices", done_, all_) : "",
                       failed_ != 0 ? fmt::format(", {} failed", failed_) : "");
  }

  Progress progress_;
  const std::vector<Point>& points_;
  std::vector<std::uint32_t> slices_;  ///< ended slices, by point
  std::uint32_t all_ = 0, done_ = 0;   ///< numbers of pieces: slices, and points that are not cut
  std::uint32_t ended_ = 0, failed_ = 0;
};

void print_summary(const sweep::BatchResult& end, const fs::path& out) {
  const std::uint64_t missing = end.count_of(PointStatus::kMissing);
  fmt::print("{} points: {} computed, {} found, {} failed{}\n", end.statuses.size(),
             end.count_of(PointStatus::kComputed), end.count_of(PointStatus::kDone), end.count_of(PointStatus::kFailed),
             missing != 0 ? fmt::format(", {} missing", missing) : "");
  if (end.workers != 0) {
    fmt::print("time:    {:.1f} s, {} worker{} busy {:.1f} % of it\n", end.seconds, end.workers,
               end.workers == 1 ? "" : "s", 100 * end.busy);
  }
  const std::string folder = sim::printable(command_text({out.string()}), 4096);
  const bool is_set = fs::exists(out / "machines.csv");
  fmt::print("results: {}\nnext:    raywatt sweep table {}{}, or raywatt report {} -o sweep.html\n",
             (out / "results.csv").string(), folder, is_set ? " --machines" : "", folder);
}

}  // namespace

void print_failures(const Store& store, const std::vector<Point>& points) {
  std::size_t failed = 0;
  for (const Point& point : points) {
    const std::optional<sweep::Failure> failure = store.read_failure(point.id);
    if (!failure || store.is_done(point.id)) continue;
    if (failed == 0) fmt::print("failed:\n");
    if (++failed <= kShownFailures) fmt::print("  {}: {}\n", label_of(point), sim::printable(failure->error, 500));
  }
  if (failed > kShownFailures) fmt::print("  and {} more\n", failed - kShownFailures);
}

int run_sweep(const SweepOptions& options) {
  if (options.file.empty() && !(options.resume && !options.out.empty())) {
    throw sim::InputError("no sweep is named; allowed: raywatt sweep run FILE, or raywatt sweep run --resume -o DIR");
  }
  check_options(options);
  if (options.wait && options.launcher != "slurm") throw sim::InputError("--wait is for --launcher slurm");
  const bool from_file = !options.file.empty();
  const fs::path out = !options.out.empty()
                           ? options.out
                           : fs::path("raywatt-out") / fmt::format("sweep-{}", options.file.stem().string());
  std::optional<SweepFolder> former;
  if (options.resume) former = SweepFolder::open(out);
  const std::vector<std::string> sets = former ? former->sets() : options.sets;
  const Planned planned = from_file ? plan_from_file(options, options.file, sets) : plan_from_folder(options, *former);
  const fs::path store_root = !options.store.empty() ? options.store
                              : former               ? former->store().root()
                                                     : Store::default_root();
  if (options.dry_run) {
    print_plan(planned.points, Store(store_root));
    return kGood;
  }
  const HoldInterrupts hold;
  const std::optional<sim::FileLock> lock = SweepFolder::try_claim(out, SweepFolder::FolderKind::kSweep);
  if (!lock)
    throw sim::InputError(fmt::format("{}: another process is running this sweep", sim::printable(out.string())));
  const SweepFolder folder = SweepFolder::create(out, SweepFolder::FolderKind::kSweep, planned.text, planned.points,
                                                 store_root, planned.slurm, sets);
  const Store store = folder.store();
  store.remove_stale();
  const std::unique_ptr<sweep::Launcher> launcher = make_launcher(options, folder);
  if (auto* slurm = dynamic_cast<sweep::SlurmLauncher*>(launcher.get()); slurm != nullptr && !options.wait) {
    const sweep::SlurmLauncher::Submitted submitted = slurm->submit_points(planned.points);
    if (submitted.points + submitted.queued != 0) {
      if (!options.quiet) print_submitted(submitted, planned.points, out);
      return kGood;
    }
  }
  BatchProgress batch(options, planned.points);
  const sweep::BatchResult end = launcher->run(
      planned.points, [&](std::size_t p, PointStatus status) { batch.count_point(p, status); },
      [&](std::size_t p) { batch.count_slice(p); });
  batch.end(end.interrupted ? "interrupted" : "done");
  const std::uint64_t computed = end.count_of(PointStatus::kComputed), found = end.count_of(PointStatus::kDone),
                      failed = end.count_of(PointStatus::kFailed), missing = end.count_of(PointStatus::kMissing);
  folder.check_exists();
  folder.log_run({{"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
                  {"host", sweep::host_name()},
                  {"points", planned.points.size()},
                  {"computed", computed},
                  {"found", found},
                  {"failed", failed},
                  {"seconds", end.seconds},
                  {"workers", end.workers},
                  {"busy", end.busy}});
  results::collect_results(folder);
  set_interrupt_note(fmt::format("kept {} of {} points in {}", computed + found, planned.points.size(), out.string()));
  if (!options.quiet) print_summary(end, out);
  if (failed != 0) print_failures(store, planned.points);
  if (missing != 0) print_missing(folder, missing);
  return failed + missing != 0 ? kCheckFailed : kGood;
}

namespace {

/// Returns one entry per line of the file `list`: the ids of the points on that line. Without a file, one entry per
/// point of the sweep. A point that is cut into slices is replaced by its slices, an entry each.
std::vector<std::vector<std::string>> read_point_id_lines(const std::vector<Point>& points, const fs::path& list) {
  std::vector<std::vector<std::string>> ids;
  if (list.empty()) {
    for (const Point& point : points) {
      if (!point.is_cut()) ids.push_back({point.id});
      for (const Point& slice : slices_of(point)) ids.push_back({slice.id});
    }
    return ids;
  }
  std::istringstream lines(sim::read_file(list, std::uint64_t{1} << 30));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    ids.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return ids;
}

/// Returns the points that `options` selects: those of some consecutive lines of its list, or of the sweep.
std::vector<Point> points_of_chunk(const SweepFolder& folder, const PointOptions& options) {
  const std::vector<Point> all = folder.read_points();
  const std::vector<std::vector<std::string>> lines = read_point_id_lines(all, options.list);
  const std::uint64_t chunks = (lines.size() + options.chunk - 1) / options.chunk;
  if (options.index >= chunks) {
    throw sim::InputError(
        fmt::format("--index {}: there are {} chunks of {} points", options.index, chunks, options.chunk));
  }
  std::map<std::string, Point> by_id;
  for (const Point& point : all) {
    by_id.emplace(point.id, point);
    for (const Point& slice : slices_of(point)) by_id.emplace(slice.id, slice);
  }
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
      points.push_back(found->second);
    }
  }
  return points;
}

}  // namespace

int compute_points(const PointOptions& options) {
  const SweepFolder folder = SweepFolder::open(options.folder);
  const std::vector<Point> points = points_of_chunk(folder, options);
  const HoldInterrupts hold;
  const std::unique_ptr<sweep::Launcher> launcher =
      sweep::make_local_launcher(folder.store(), {.jobs = options.jobs,
                                                  .threads = 1,
                                                  .retry_failed = options.retry_failed,
                                                  .keep_streams = true,
                                                  .log = folder.log_folder()});
  const sweep::BatchResult end = launcher->run(points);
  return end.count_of(PointStatus::kFailed) != 0 ? kCheckFailed : kGood;
}

namespace {

/// True if all slices of a point are done or one has failed, but the point itself is neither done nor failed.
bool is_left_unjoined(const Store& store, const Point& point) {
  const auto has = [&](PointStatus status) {
    return [&, status](const Point& p) { return store.status_of(p.id) == status; };
  };
  if (!point.is_cut() || has(PointStatus::kDone)(point) || has(PointStatus::kFailed)(point)) return false;
  const std::vector<Point> slices = slices_of(point);
  return std::ranges::all_of(slices, has(PointStatus::kDone)) || std::ranges::any_of(slices, has(PointStatus::kFailed));
}

}  // namespace

void join_sweep(const SweepFolder& folder) {
  const Store store = folder.store();
  const HoldInterrupts hold;
  sweep::PointComputer computer(store, 0);
  for (const Point& point : folder.read_points()) {
    try {
      if (is_left_unjoined(store, point)) computer.compute_point(point, {});
    } catch (const sim::IoError& error) {
      print_message("warning: slices of point {} are not joined: {}", point.n, error.what());
    }
  }
}

namespace {

/// Counts the points of a sweep by status. Reads only its folder and the store.
sim::Json count_points(const SweepFolder& folder) {
  const Store store = folder.store();
  std::uint64_t done = 0, failed = 0, running = 0, damaged = 0, slices = 0, slices_done = 0;
  const std::vector<Point> points = folder.read_points();
  sim::Json failures = sim::Json::array();
  for (const Point& point : points) {
    const PointStatus status = store.status_of(point.id);
    if (is_done(status)) {
      done += 1;
    } else if (const std::optional<sweep::Failure> failure = store.read_failure(point.id)) {
      failed += 1;
      failures.push_back({{"n", point.n}, {"id", point.id}, {"exit", failure->exit}, {"error", failure->error}});
    } else {
      bool is_running = store.is_locked(point.id);
      for (const Point& slice : slices_of(point)) {
        slices += 1;
        slices_done += store.is_done(slice.id) ? 1 : 0;
        is_running = is_running || store.is_locked(slice.id);
      }
      running += is_running ? 1 : 0;
      damaged += status == PointStatus::kDamaged ? 1 : 0;
    }
  }
  const std::optional<SweepFolder::Runner> runner = folder.find_runner();
  sim::Json counts = {
      {"points", points.size()},
      {"done", done},
      {"failed", failed},
      {"missing", points.size() - done - failed},
      {"running", running},
      {"damaged", damaged},
      {"runner", runner ? sim::Json{{"host", runner->host}, {"process", runner->process}} : sim::Json(nullptr)},
      {"store", store.root().string()},
      {"failures", failures}};
  if (slices != 0) counts["slices_of_missing"] = {{"slices", slices}, {"done", slices_done}};
  return counts;
}

std::uint64_t count_of(const sim::Json& status, const char* key) { return status.at(key).get<std::uint64_t>(); }

std::string counts_text(const sim::Json& status) {
  std::string text = fmt::format("{} points: {} done, {} failed, {} missing ({} of them being computed, {} damaged)",
                                 count_of(status, "points"), count_of(status, "done"), count_of(status, "failed"),
                                 count_of(status, "missing"), count_of(status, "running"), count_of(status, "damaged"));
  if (const auto slices = status.find("slices_of_missing"); slices != status.end()) {
    text += fmt::format("; of their slices {} of {} are done", count_of(*slices, "done"), count_of(*slices, "slices"));
  }
  return text;
}

/// Returns the number of points without a result. For a point that is cut, the slices without a result are counted.
std::uint64_t missing_pieces(const sim::Json& status) {
  const auto slices = status.find("slices_of_missing");
  return slices == status.end() ? count_of(status, "missing") : count_of(*slices, "slices") - count_of(*slices, "done");
}

/// Live view of a sweep: the numbers of its points by status.
class SweepView final : public View {
 public:
  void set_counts(std::string counts) {
    const std::lock_guard lock(mutex_);
    counts_ = std::move(counts);
  }
  std::vector<std::string> lines() override {
    const std::lock_guard lock(mutex_);
    return {counts_};
  }
  SmallPicture picture(std::size_t, std::size_t) override { return {}; }

 private:
  std::mutex mutex_;
  std::string counts_;
};

}  // namespace

void watch_sweep(const fs::path& path) {
  constexpr auto kBetween = std::chrono::seconds(1);
  const SweepFolder folder = SweepFolder::open(path);
  SweepView view;
  sim::Json status = count_points(folder);
  std::uint32_t all = 0;
  for (const Point& point : folder.read_points()) all += point.piece_count();
  const auto done_pieces = [&status, all] { return all - static_cast<std::uint32_t>(missing_pieces(status)); };
  const std::uint32_t before = done_pieces();
  {
    Progress progress("watch", false, &view);
    progress.begin_part("computing", 0, all, before);
    for (;; status = count_points(folder)) {
      const std::uint64_t missing = count_of(status, "missing");
      view.set_counts(counts_text(status));
      progress.set_tiles_done(done_pieces(), 0, 0);
      const bool is_run = folder.find_runner() || count_of(status, "running") != 0 || sweep::slurm_status(folder);
      if (missing == 0 || !is_run) break;
      std::this_thread::sleep_for(kBetween);
    }
    progress.finish(count_of(status, "missing") == 0 ? "done" : "no process is running this sweep");
  }
  fmt::print("{}\n", counts_text(status));
}

void print_sweep_status(const fs::path& path, bool json) {
  const SweepFolder folder = SweepFolder::open(path);
  sim::Json status = count_points(folder);
  const std::optional<sim::Json> slurm = sweep::slurm_status(folder);
  if (slurm) status["slurm"] = *slurm;
  if (json) {
    fmt::print("{}", sim::json_lines(status));
    return;
  }
  fmt::print("{}\n", counts_text(status));
  if (const std::optional<SweepFolder::Runner> runner = folder.find_runner()) {
    fmt::print("run by process {} on {}\n", runner->process, runner->host);
  }
  if (slurm) sweep::print_slurm_status(*slurm);
  fmt::print("store: {}\n", folder.store().root().string());
  print_failures(folder.store(), folder.read_points());
}

void cancel_sweep(const fs::path& path) {
  constexpr auto kPollPeriod = std::chrono::milliseconds(20);
  constexpr int kPolls = 1000;
  const SweepFolder folder = SweepFolder::open(path);
  const std::optional<SweepFolder::Runner> runner = folder.find_runner();
  const bool is_here = runner && runner->host == sweep::host_name() && runner->process > 1;
  if (is_here) {
    ::kill(runner->process, SIGTERM);
    for (int k = 0; k < kPolls && folder.find_runner(); ++k) std::this_thread::sleep_for(kPollPeriod);
    if (folder.find_runner()) throw sim::IoError(fmt::format("process {} does not end", runner->process));
  }
  // A process on another host that waits for the jobs ends when the jobs end.
  const bool had_jobs = sweep::cancel_on_slurm(folder);
  if (runner && !is_here && !had_jobs) {
    throw sim::InputError(fmt::format("{}: is run by process {} on {}; cancel it there", sim::printable(path.string()),
                                      runner->process, sim::printable(runner->host)));
  }
  if (!runner && !had_jobs) {
    fmt::print("no process is running this sweep\n");
    return;
  }
  fmt::print("cancelled; what is finished is kept. Go on with: {}\n",
             command_text({"raywatt", "sweep", "run", "--resume", "-o", path.string()}));
}

}  // namespace tools
