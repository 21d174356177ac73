#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools::sweep {

/// A sweep's part of Slurm's queue. Its tasks are known by their script, submit-K.sh in the sweep's folder.
struct SlurmQueue {
  std::uint64_t running = 0, waiting = 0;  ///< tasks
  std::set<std::string> jobs;              ///< ids of their arrays
  std::set<std::string> reasons;           ///< why tasks wait
};
/// InputError if there is no Slurm on this host, IoError if it does not answer.
SlurmQueue queue_of(const SweepFolder& folder);

/// Ids of the points of these tasks.
std::set<std::string> queued_points(const SweepFolder& folder);

/// Has any of the sweep's points ever been handed in?
bool was_submitted(const SweepFolder& folder);

/// Cancels what is in the queue and waits until it has ended, a minute at most; what was there.
SlurmQueue cancel_jobs(const SweepFolder& folder);

/// Shares points out: a line a task, with the ids of at most `chunk` points. Those with the same recorded work are side
/// by side, and in one task where they fit.
std::vector<std::string> task_lines(const std::vector<const Point*>& points, std::uint64_t chunk);

}  // namespace tools::sweep
