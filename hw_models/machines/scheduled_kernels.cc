#include "hw_models/machines/scheduled_kernels.h"

#include "shader_kernels/catalogue.h"

namespace hw {

ScheduledKernels schedule_kernels(const GpuConfig& config) {
  SrpConfig srp = config.srp;
  if (config.ideal.tile_buffer) srp.array.local_ports = 64;  // more than any kernel can use
  ScheduledKernels out;
  for (const kernels::KernelInfo& kernel : kernels::catalogue()) {
    out.kernels.push_back(schedule(kernel.graph, srp));
    out.conflicts.push_back(bank_conflicts(out.kernels.back(), kernel.graph, config.tile_buffer.banks));
  }
  return out;
}

}  // namespace hw
