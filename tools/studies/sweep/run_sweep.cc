#include <algorithm>
#include <ctime>
#include <optional>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/host/exit_code.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/studies/sweep/launch/slurm_words.h"
#include "tools/studies/sweep/results/index/collect.h"
#include "tools/studies/sweep/spec/plan.h"
#include "tools/studies/sweep/store/folder.h"
#include "tools/studies/sweep/sweep.h"

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

struct Planned {
  std::string text;  ///< text of the file
  std::vector<Point> points;
  std::vector<std::string> slurm;
};

/// Files that it names are seen from the folder that it is in.
Planned plan_from_file(const SweepOptions& options, const fs::path& file) {
  const sweep::Spec spec = sweep::read_spec(file);
  Progress progress(options.progress == "json" ? "none" : options.progress, options.quiet);
  progress.expect_parts(1, "sweep");
  progress.set_phase("choosing points");
  const auto tell = [&](std::size_t points, std::size_t of) {
    if (points == 1) progress.begin_part("planning", 0, static_cast<std::uint32_t>(of));
    progress.set_tiles_done(static_cast<std::uint32_t>(points), 0, 0);
  };
  return {sim::read_file(file, 1 << 20), sweep::plan(spec, file.parent_path(), tell), spec.slurm};
}

/// The points of a folder, with their keys of today; planned anew if it was killed before it had any.
Planned plan_from_folder(const SweepOptions& options, const SweepFolder& folder) {
  const fs::path file = folder.path() / "sweep.yaml";
  Planned planned{sim::read_file(file, 1 << 20), folder.points(), folder.slurm()};
  if (planned.points.empty()) return plan_from_file(options, file);
  sweep::PointKeys keys;
  for (Point& point : planned.points) keys.set_key(point);
  return planned;
}

/// "to compute, 3 of 8 slices in the store"
std::string state_text(const Point& point, const Store& store) {
  const auto is_there = [&](const Point& one) { return store.state(one.id) == Store::State::kGood; };
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
    cells.push_back(state_text(point, store));
    there += cells.back() == "in the store" ? 1 : 0;
    table.add_row(std::move(cells));
  }
  fmt::print("{}\n{} points, {} of them in the store\n", table.text(), points.size(), there);
  for (const Point& point : points) {
    if (!point.error.empty()) fmt::print("impossible: {}: {}\n", name_of(point), sim::printable(point.error, 500));
  }
}

/// Tells how far a batch is: by points, or by slices where points are cut.
class Watcher {
 public:
  Watcher(const SweepOptions& options, const std::vector<Point>& points)
      : progress_(options.progress, options.quiet), points_(points), slices_(points.size()) {
    for (const Point& point : points) all_ += point.pieces();
    progress_.expect_parts(1, "sweep");
    progress_.begin_part(text(), 0, all_);
  }
  void slice_ended(std::size_t p) {
    slices_[p] += 1;
    show(1);
  }
  void ended(std::size_t p, Fate fate) {
    ended_ += 1;
    failed_ += fate == Fate::kFailed ? 1 : 0;
    show(points_[p].pieces() - slices_[p]);
  }
  void end(const std::string& how) { progress_.finish(how); }

 private:
  void show(std::uint32_t more) {
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
  std::vector<std::uint32_t> slices_;  ///< ended slices of each point
  std::uint32_t all_ = 0, done_ = 0;   ///< slices, and points that have none
  std::uint32_t ended_ = 0, failed_ = 0;
};

void print_summary(const sweep::BatchEnd& end, const fs::path& out) {
  const std::uint64_t missing = end.count(Fate::kMissing);
  fmt::print("{} points: {} computed, {} found, {} failed{}\n", end.fates.size(), end.count(Fate::kComputed),
             end.count(Fate::kFound), end.count(Fate::kFailed),
             missing != 0 ? fmt::format(", {} missing", missing) : "");
  if (end.workers != 0) {
    fmt::print("time:    {:.1f} s, {} worker{} busy {:.1f} % of it\n", end.seconds, end.workers,
               end.workers == 1 ? "" : "s", 100 * end.busy);
  }
  fmt::print("results: {}\n", (out / "results.csv").string());
}

}  // namespace

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

int run_sweep(const SweepOptions& options) {
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
  const Planned planned = from_file ? plan_from_file(options, options.file) : plan_from_folder(options, *former);
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
      if (!options.quiet) tell_submitted(submitted, planned.points, out);
      return kGood;
    }
  }
  Watcher watcher(options, planned.points);
  const sweep::BatchEnd end = launcher->run(
      planned.points, [&](std::size_t p, Fate fate) { watcher.ended(p, fate); },
      [&](std::size_t p) { watcher.slice_ended(p); });
  watcher.end(end.interrupted ? "interrupted" : "done");
  const std::uint64_t computed = end.count(Fate::kComputed), found = end.count(Fate::kFound),
                      failed = end.count(Fate::kFailed), missing = end.count(Fate::kMissing);
  folder.check_there();
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
  set_interrupt_note(fmt::format("kept {} of {} points in {}", computed + found, planned.points.size(), out.string()));
  if (!options.quiet) print_summary(end, out);
  if (failed != 0) print_failures(store, planned.points);
  if (missing != 0) tell_missing(folder, missing);
  return failed + missing != 0 ? kCheckFailed : kGood;
}

}  // namespace tools
