#pragma once
#include <span>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule.h"
#include "sim/time.h"

namespace hw {

/// Returns the time without a retired item after which a run counts as a livelock. This is the value of key `watchdog`
/// or, if that is 0, several times an upper bound of an item's latency: a chunk of the longest kernel, then dependent
/// memory lines. Each line waits for all requests that can be in flight, a refresh, a power-up and a row change.
sim::Time livelock_timeout(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                           std::span<const BankConflicts> conflicts);

}  // namespace hw
