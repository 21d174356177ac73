#pragma once
#include <vector>

#include "sim/unit_report.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Every unit of a machine before it has done anything: blocks, storage, reasons, and counters with what they cost.
/// `rasterises`: its frames have work for rasterisers, which it has then.
std::vector<sim::UnitReport> idle_units(const hw::GpuConfig& config, bool rasterises = false);

}  // namespace tools
