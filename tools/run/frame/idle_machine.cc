#include "tools/run/frame/idle_machine.h"

#include <memory>

#include "hw_models/machines/gpu.h"
#include "tools/run/frame/machine_run.h"

namespace tools {

std::vector<sim::UnitReport> idle_unit_reports(const hw::GpuConfig& config, bool rasterises) {
  const traces::MemoryImage nothing;
  hw::TileSource tiles;
  // Kernels that no tile uses get no schedule: scheduling would dominate the time.
  hw::Gpu::Workload workload{
      .image = nothing, .parents = {}, .scheduled = std::make_shared<const hw::ScheduledKernels>()};
  if (rasterises) workload.needs.raster = traces::RasterDemands{};
  return std::make_unique<hw::Gpu>(config, workload, tiles)->unit_reports();
}

}  // namespace tools
