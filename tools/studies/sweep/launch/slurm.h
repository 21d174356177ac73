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

/// Computes points of the sweep in a folder as job arrays of Slurm. Points are done when the
/// store has their results, so no database of jobs is needed.
///
///   submit-K.txt    one line a task: the ids of its points
///   submit-K.sh     script of the tasks of array K; its name identifies the array in the queue
///   log/slurm-*.log output of tasks
class SlurmLauncher final : public Launcher {
 public:
  struct Options {
    std::uint64_t chunk = 0;  ///< points of a task; 0: such that there are a hundred tasks
    std::uint32_t tasks = 0;  ///< tasks of an array that run at a time; 0: Slurm decides
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
  /// Submits the points and waits until they have ended. After an interrupt the jobs continue. Points whose tasks were
  /// stopped stay kMissing.
  BatchEnd run_batch(std::span<const Point> points, const PointWatch& watch) override;
  std::string submit_array(std::span<const std::string> lines);

  const SweepFolder folder_;
  const Options options_;
};

/// Distributes points over tasks: one line a task, with the ids of at most `chunk` points. Points that share recorded
/// work are put next to each other, in one task where they fit.
std::vector<std::string> task_lines(const std::vector<const Point*>& points, std::uint64_t chunk);

/// Prints the number of submitted points and tasks, and the commands that follow or cancel the jobs.
void print_submitted(const SlurmLauncher::Submitted& submitted, std::span<const Point> points,
                     const std::filesystem::path& out);
/// Prints that tasks have ended without results, with the last line of their logs.
void print_missing(const SweepFolder& folder, std::uint64_t missing);

/// Returns {"running", "waiting", "jobs", "reasons"} of a submitted sweep, or {"error"} if Slurm does not answer;
/// nothing if it was never submitted.
std::optional<sim::Json> slurm_status(const SweepFolder& folder);
void print_slurm_status(const sim::Json& status);

/// Cancels the jobs of a sweep and waits until they have ended, a minute at most. False if none is in the queue.
bool cancel_on_slurm(const SweepFolder& folder);

}  // namespace tools::sweep
