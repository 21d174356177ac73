#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/report/area.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"

namespace sim {

// A table entry that no unit or counter uses is a misspelling. These functions throw InputError for it, with the
// nearest known name.

/// Checks that an energy table lists exactly the events `declared`: all events that counters name, without those of
/// devices. Throws InputError otherwise.
void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared);

/// Checks the unit names in an energy table. Tables by unit may contain only the given units, as "<block>.<kind>" or
/// "<block>"; tables by part, as "<block>.<kind>.<part>" or "<block>.<part>". Throws InputError otherwise.
void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units);
void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units);

/// Returns a warning for every kind of unit whose memory array is smaller or larger than the sizes of its energy or
/// area curve, so that values are extrapolated. `events`: EnergyConfig::events; `arrays`: AreaConfig::arrays, may be
/// empty.
std::vector<std::string> sizes_outside_curves(std::span<const UnitReport> units,
                                              const std::map<std::string, Band>& events,
                                              const std::map<std::string, Band>& arrays);

}  // namespace sim
