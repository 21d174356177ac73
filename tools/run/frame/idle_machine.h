#pragma once
#include <vector>

#include "sim/unit_report.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Returns every unit of a machine before its first cycle: blocks, storage, reasons, and counters with their costs.
/// `rasterises`: the machine has rasterisers.
std::vector<sim::UnitReport> idle_units(const hw::GpuConfig& config, bool rasterises = false);

}  // namespace tools
