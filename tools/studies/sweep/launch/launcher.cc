#include "tools/studies/sweep/launch/launcher.h"

#include <algorithm>
#include <sstream>

#include "sim/error.h"
#include "tools/studies/sweep/launch/local_launcher.h"
#include "tools/studies/sweep/launch/slurm.h"

namespace tools::sweep {
namespace {

/// Adds the times of a later batch.
void add_times(const BatchEnd& later, BatchEnd& end) {
  const double seconds = end.seconds + later.seconds;
  if (seconds > 0) end.busy = (end.busy * end.seconds + later.busy * later.seconds) / seconds;
  end.seconds = seconds;
  end.workers = std::max(end.workers, later.workers);
  end.interrupted = end.interrupted || later.interrupted;
}

}  // namespace

std::uint64_t BatchEnd::count_of(PointStatus status) const {
  return static_cast<std::uint64_t>(std::ranges::count(statuses, status));
}

void Launcher::remove_failure(const Point& point) const {
  if (const std::optional<sim::FileLock> lock = store_.lock_point(point.id)) store_.remove_failure(point.id);
}

/// A batch with cut points: first their slices are computed with the other points, then the slices are joined.
class Launcher::CutBatch {
 public:
  CutBatch(Launcher& launcher, std::span<const Point> points) : launcher_(launcher), points_(points) {
    cut_.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const std::vector<Point> slices = launcher.needs_computing(launcher.store_.status_of(points[p].id))
                                            ? slices_of(points[p])
                                            : std::vector<Point>();
      if (slices.empty()) add_job(points[p], p);
      for (const Point& slice : slices) add_job(slice, p);
      if (!slices.empty() && launcher.retry_failed_) launcher.remove_failure(points[p]);
      cut_[p].is_cut = !slices.empty();
    }
  }

  BatchEnd run(const PointWatch& watch, const SliceWatch& slice_watch) {
    BatchEnd end = launcher_.run_batch(jobs_, [&](std::size_t j, PointStatus status) {
      jobs_[j].slice != 0 ? slice_watch(point_of_[j]) : watch(point_of_[j], status);
    });
    std::vector<PointStatus> statuses(points_.size(), PointStatus::kMissing);
    for (std::size_t j = 0; j < jobs_.size(); ++j) {
      Cut& cut = cut_[point_of_[j]];
      if (!cut.is_cut) statuses[point_of_[j]] = end.statuses[j];
      cut.is_new = cut.is_new || end.statuses[j] == PointStatus::kComputed;
      cut.lacks_some = cut.lacks_some || end.statuses[j] == PointStatus::kMissing;
    }
    end.statuses = std::move(statuses);
    join_slices(end, watch);
    return end;
  }

 private:
  struct Cut {
    bool is_cut = false;
    bool is_new = false;      ///< a slice was computed
    bool lacks_some = false;  ///< a slice was not
  };

  void add_job(const Point& job, std::size_t point) {
    jobs_.push_back(job);
    point_of_.push_back(point);
  }

  /// Joins slices that the worker of the last one has not joined.
  void join_slices(BatchEnd& end, const PointWatch& watch) {
    std::vector<Point> wholes;
    std::vector<std::size_t> indices;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (!cut_[p].is_cut || cut_[p].lacks_some ||
          (end.interrupted && launcher_.needs_computing(launcher_.store_.status_of(points_[p].id))))
        continue;
      wholes.push_back(points_[p]);
      indices.push_back(p);
    }
    const BatchEnd joined = launcher_.run_batch(wholes, [&](std::size_t w, PointStatus status) {
      const bool is_new = status == PointStatus::kDone && cut_[indices[w]].is_new;
      end.statuses[indices[w]] = is_new ? PointStatus::kComputed : status;
      watch(indices[w], end.statuses[indices[w]]);
    });
    add_times(joined, end);
  }

  Launcher& launcher_;
  const std::span<const Point> points_;
  std::vector<Cut> cut_;  ///< by point
  std::vector<Point> jobs_;
  std::vector<std::size_t> point_of_;  ///< index of the point of each job
};

BatchEnd Launcher::run(std::span<const Point> points, const PointWatch& watch, const SliceWatch& slice_watch) {
  if (std::ranges::none_of(points, &Point::is_cut)) return run_batch(points, watch);
  return CutBatch(*this, points).run(watch, slice_watch);
}

}  // namespace tools::sweep

namespace tools {

void check_options(const LauncherOptions& options) {
  const bool has_slurm_options = !options.slurm_arguments.empty() || options.chunk != 0;
  if (options.launcher != "slurm" && has_slurm_options) {
    throw sim::InputError("--slurm-args and --chunk are for --launcher slurm");
  }
}

std::unique_ptr<sweep::Launcher> make_launcher(const LauncherOptions& options, const sweep::SweepFolder& folder) {
  if (options.launcher == "slurm") {
    std::vector<std::string> arguments = folder.slurm_arguments();  // of the file, then of the command line
    for (const std::string& several : options.slurm_arguments) {
      std::istringstream words(several);
      for (std::string word; words >> word;) arguments.push_back(word);
    }
    return std::make_unique<sweep::SlurmLauncher>(folder,
                                                  sweep::SlurmLauncher::Options{.chunk = options.chunk,
                                                                                .tasks = options.jobs,
                                                                                .retry_failed = options.retry_failed,
                                                                                .arguments = std::move(arguments)});
  }
  return std::make_unique<sweep::LocalLauncher>(
      folder.store(), sweep::LocalLauncher::Options{
                          .jobs = options.jobs, .retry_failed = options.retry_failed, .log = folder.log_folder()});
}

}  // namespace tools
