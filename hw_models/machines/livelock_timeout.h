#pragma once
#include <span>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/schedule.h"
#include "sim/time.h"

namespace hw {

/// Returns the time without a retired item after which a run counts as a livelock. If the key `watchdog` is 0, this is
/// several times an upper bound of an item's latency. The bound is the time of one chunk of the slowest kernel, plus
/// that of several dependent reads of memory lines. Each read waits for all requests that can be in flight, a refresh,
/// a power-up and a row change.
sim::Time livelock_timeout(const GpuConfig& config, std::span<const KernelSchedule> kernels,
                           std::span<const BankConflicts> conflicts);

}  // namespace hw
