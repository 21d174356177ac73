#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools::sweep {

/// Job arrays of Slurm. Slurm supplies attempts; what has come out is told by the store alone.
///
///   submit-K.txt    a line a task: the ids of its points
///   submit-K.sh     what each task of array K runs; by its name the array is found in the queue again
///   log/slurm-*.log what tasks said
///
/// The points of a batch are points of the sweep in the folder.
class SlurmLauncher final : public Launcher {
 public:
  struct Options {
    std::uint64_t chunk = 0;  ///< points of a task; 0: as many as make a hundred tasks
    std::uint32_t tasks = 0;  ///< tasks of an array at a time; 0: as many as Slurm likes
    bool retry_failed = false;
    std::vector<std::string> arguments;  ///< for sbatch, which sees them as they are
  };
  /// InputError if the arguments are not for others to choose.
  SlurmLauncher(const SweepFolder& folder, const Options& options);

  struct Submitted {
    std::uint64_t points = 0, tasks = 0;
    std::vector<std::string> jobs;  ///< ids
    std::uint64_t queued = 0;       ///< points that an earlier call has handed in and that wait or are being computed
  };
  /// Hands in the points that have neither a result nor a failure and are not in the queue, and returns at once.
  /// InputError with Slurm's words if it refuses; what it took before goes on.
  Submitted submit(std::span<const Point> points);

 private:
  /// The same, and waits. After an interrupt the jobs go on. Points whose tasks are stopped from outside stay kMissing.
  BatchEnd play(std::span<const Point> points, const Watch& watch) override;

  std::string submit_array(std::span<const std::string> lines);

  const SweepFolder folder_;
  const Options options_;
};

}  // namespace tools::sweep
