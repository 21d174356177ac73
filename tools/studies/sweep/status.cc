#include <chrono>
#include <csignal>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/sweep/launch/slurm.h"
#include "tools/studies/sweep/sweep.h"

namespace tools {
namespace {

namespace fs = std::filesystem;
using sweep::Point;
using sweep::PointStatus;
using sweep::Store;
using sweep::SweepFolder;

/// Counts the points of a sweep by status, from its folder and the store alone.
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

/// Number of points without a result; where they are cut, of slices.
std::uint64_t missing_pieces(const sim::Json& status) {
  const auto slices = status.find("slices_of_missing");
  return slices == status.end() ? count_of(status, "missing") : count_of(*slices, "slices") - count_of(*slices, "done");
}

/// Live view of the counts of a sweep.
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
    fmt::print("{}", sim::json_text(status));
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
  // A process on another host that waits for the jobs ends when they do.
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
