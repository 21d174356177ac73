#pragma once
#include <vector>

#include "sim/unit_report.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Returns reports of all units of a machine before its first cycle: block, storage, cycle reasons, and counters with
/// their energy events. `rasterises`: the machine has rasterisers.
std::vector<sim::UnitReport> idle_unit_reports(const hw::GpuConfig& config, bool rasterises = false);

}  // namespace tools
