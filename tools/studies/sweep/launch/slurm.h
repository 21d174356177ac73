#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/sweep/launch/launcher.h"

namespace tools::sweep {

/// Simulates points of a sweep as job arrays of Slurm. A point is done when the store has its result, so no database of
/// jobs is needed.
///
///   submit-K.txt    a line per task: the ids of its points
///   submit-K.sh     script of the tasks of array K; its name identifies the array in the queue
///   log/slurm-*.log output of tasks
class SlurmLauncher final : public Launcher {
 public:
  struct Options {
    std::uint64_t chunk = 0;  ///< points per task; 0: chosen to give a hundred tasks
    std::uint32_t tasks = 0;  ///< maximum number of tasks of an array that run at once; 0: Slurm decides
    bool retry_failed = false;
    std::vector<std::string> arguments;  ///< passed to sbatch unchanged
  };
  /// Throws InputError for arguments that the launcher sets itself.
  SlurmLauncher(const SweepFolder& folder, const Options& options);

  struct Submitted {
    std::uint64_t points = 0, tasks = 0;
    std::vector<std::string> jobs;  ///< ids
    std::uint64_t queued = 0;       ///< points of earlier submissions that wait or are being computed
  };
  /// Submits the points that have neither a result nor a failure and are not in the queue, and returns. Throws
  /// InputError with the message of Slurm if it refuses; jobs that were submitted before then continue.
  Submitted submit_points(std::span<const Point> points);

 private:
  /// Submits the points and waits until they have ended. If this process is interrupted, the jobs continue. If a task
  /// is stopped, its points stay kMissing.
  BatchResult run_batch(std::span<const Point> points, const PointWatch& watch) override;
  std::string submit_array(std::span<const std::string> lines);

  const SweepFolder folder_;
  const Options options_;
};

/// Distributes points over Slurm tasks. Returns a line per task, with the ids of at most `chunk` points. Points that
/// replay the same recorded rays are put into one task if they fit.
std::vector<std::string> task_lines(const std::vector<const Point*>& points, std::uint64_t chunk);

/// Prints the number of submitted points and tasks, and the commands that follow or cancel the jobs.
void print_submitted(const SlurmLauncher::Submitted& submitted, std::span<const Point> points,
                     const std::filesystem::path& out);
/// Prints that tasks have ended without the results of `missing` points, with the last line of the newest log.
void print_missing(const SweepFolder& folder, std::uint64_t missing);

/// Returns the state of a sweep's jobs: {"running", "waiting", "jobs", "reasons"}, or {"error"} if Slurm does not
/// answer. Returns nothing if the sweep was never submitted.
std::optional<sim::Json> slurm_status(const SweepFolder& folder);
void print_slurm_status(const sim::Json& status);

/// Cancels the jobs of a sweep and waits at most a minute for their end. Returns false if none was in the queue.
bool cancel_on_slurm(const SweepFolder& folder);

}  // namespace tools::sweep
