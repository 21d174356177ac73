#pragma once
#include <span>

#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace tools {

/// Every figure of a table must be one that some counter of the units can use, and the other way round. InputError.
void check_energy_events(std::span<const sim::UnitReport> units, const sim::EnergyConfig& config);

}  // namespace tools
