#pragma once
#include <span>
#include <string>

#include "sim/report/area.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

// A figure that nobody can use is a misspelling: these throw InputError for it, with the nearest name that is known.

/// The table's events must be exactly those of `declared`: all that counters may name, without the device's.
void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared);

/// Tables by unit may name no others than these, as "<block>.<kind>" or "<block>"; tables by part, as
/// "<block>.<kind>.<part>" or "<block>.<part>".
void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units);
void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units);

}  // namespace sim
