#pragma once
#include <vector>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/bank_conflicts.h"
#include "hw_models/srp/schedule.h"

namespace hw {

/// All kernels as a machine's shader cores run them, by KernelId.
struct ScheduledKernels {
  std::vector<KernelSchedule> kernels;
  std::vector<BankConflicts> conflicts;
};
ScheduledKernels schedule_kernels(const GpuConfig& config);

}  // namespace hw
