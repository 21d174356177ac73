#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/studies/sweep/launch/compute.h"
#include "tools/studies/sweep/store/store.h"

namespace tools::sweep {

/// Result of simulating a batch of points of a sweep.
struct BatchResult {
  std::vector<PointStatus> statuses;  ///< statuses in the order of the batch's points
  double seconds = 0;                 ///< host time from the first point begun to the last one finished
  double busy = 0;                    ///< share of `seconds` in which workers had a point; 0 if none was begun
  std::uint32_t workers = 0;
  bool interrupted = false;  ///< an interrupt ended the batch; some points may have no result
  std::uint64_t count_of(PointStatus status) const;
};

/// Simulates batches of points of a sweep and writes the results to a store.
///
///   const auto launcher = make_local_launcher(store, {.jobs = 2});
///   const BatchResult end = launcher->run(points);
///   if (is_done(end.statuses[0])) use(*store.read_report(points[0].id));
///
/// 1. Points must have their ids (PointKeys::set_key). Points with the same id are simulated once.
/// 2. Points that are done are not computed again; failed points only with `retry_failed`.
/// 3. A point that fails or crashes its worker does not stop the batch.
/// 4. If a point is cut into slices, each slice is given to a worker like a point.
class Launcher {
 public:
  virtual ~Launcher() = default;
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Called when a point has ended, with its index in the batch.
  using PointWatch = std::function<void(std::size_t point, PointStatus status)>;
  /// Called when a slice of a point has ended, with the index of the point.
  using SliceWatch = std::function<void(std::size_t point)>;
  /// Returns when all points have ended, or when an interrupt is pending (the caller delays interrupts,
  /// tools/host/process.h). Throws IoError if the store cannot be written; finished points are kept.
  BatchResult run(
      std::span<const Point> points, const PointWatch& watch = [](std::size_t, PointStatus) {},
      const SliceWatch& slice_watch = [](std::size_t) {});

 protected:
  Launcher(Store store, bool retry_failed) : store_(std::move(store)), retry_failed_(retry_failed) {}

  /// Simulates slices and uncut points. A cut point is passed after all its slices have ended, to join them.
  virtual BatchResult run_batch(std::span<const Point> points, const PointWatch& watch) = 0;

  /// True if a point with this status must still be computed: it is not done, and if it failed, it is retried.
  bool needs_computing(PointStatus status) const {
    return !is_done(status) && (retry_failed_ || status != PointStatus::kFailed);
  }
  /// Removes the recorded failure of a point, so that a failure recorded later is known to be new.
  void remove_failure(const Point& point) const;

  const Store store_;
  const bool retry_failed_;

 private:
  class CutBatch;
};

/// True if it is quicker to record the whole frame once for `points` points with sampled tiles than to render the
/// samples of each. `share`: share of the frame that a point samples. Every point renders a pilot of the frame, too.
bool is_record_quicker(std::size_t points, double share);

/// Options of make_local_launcher().
struct LocalOptions {
  std::uint32_t jobs = 0;     ///< workers; 0: one for each core of the host
  std::uint32_t threads = 0;  ///< threads of each worker; 0: the host's cores divided by the number of workers
  bool retry_failed = false;
  bool keep_streams = false;    ///< keep streams (recorded rays) after their last use, for later batches
  std::filesystem::path log{};  ///< folder for the output of workers; empty: it is discarded
};

/// Returns a launcher that computes points in worker processes on this host. Workers live as long as the launcher and
/// compute one point after the other. A worker that crashes fails only its point. The calling process should have one
/// thread, because it forks.
std::unique_ptr<Launcher> make_local_launcher(const Store& store, const LocalOptions& options);

}  // namespace tools::sweep

namespace tools {

/// Options that choose the launcher of a sweep or a search.
struct LauncherOptions {
  std::string launcher = "local";
  std::uint32_t jobs = 0;
  bool retry_failed = false;
  std::vector<std::string> slurm_arguments;
  std::uint64_t chunk = 0;
  bool keep_streams = false;  ///< as in LocalOptions
};

/// Throws InputError for options that belong to another launcher than the chosen one.
void check_options(const LauncherOptions& options);
std::unique_ptr<sweep::Launcher> make_launcher(const LauncherOptions& options, const sweep::SweepFolder& folder);

}  // namespace tools
