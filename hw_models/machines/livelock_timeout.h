#pragma once
#include <span>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule.h"
#include "sim/time.h"

namespace hw {

/// Returns the longest time that a GPU may run without retiring an item before the run is a livelock: the key
/// `watchdog`. If that is 0, several times the longest latency of an item: a chunk of the longest kernel, then lines
/// from memory; every line waits for all requests that can be in flight, a refresh, a power-up and a row change.
sim::Time livelock_timeout(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                           std::span<const BankConflicts> conflicts);

}  // namespace hw
