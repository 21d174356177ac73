#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "tools/studies/sweep/folder.h"

namespace tools::sweep {

/// What of a sweep is in Slurm's queue. Its tasks are known by their script, submit-K.sh in the sweep's folder.
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

}  // namespace tools::sweep
