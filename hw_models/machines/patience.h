#pragma once
#include <span>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule.h"
#include "sim/time.h"

namespace hw {

/// Longest time for which a machine may run without retiring anything: `watchdog`, or, if that is 0, several times the
/// longest latency that an item can meet on this machine: a chunk of the longest kernel, and behind it lines of memory,
/// each of which waits for all that may be under way and meets a refresh, a power-up and a row change.
sim::Time patience(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                   std::span<const BankConflicts> conflicts);

}  // namespace hw
