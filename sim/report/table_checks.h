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

// A table entry that no unit or counter uses is assumed to be misspelt. These functions then throw InputError with the
// nearest known name.

/// Throws InputError unless the events in an energy table are exactly those in `declared`: the events of all counters
/// except the counters of the block "dram".
void check_energy_events(const EnergyConfig& config, std::span<const std::string> declared);

/// Checks that an energy table contains only names of the given units and their parts. Names of units are
/// "<block>.<kind>" or "<block>", those of parts "<block>.<kind>.<part>" or "<block>.<part>". Throws InputError for
/// other names.
void check_unit_names(const EnergyConfig& config, std::span<const UnitReport> units);
void check_unit_names(const AreaConfig& config, std::span<const UnitReport> units);

/// Returns a warning for every kind of unit whose memory array has a size outside its energy or area curve, so that
/// values are extrapolated. `events`: EnergyConfig::events. `arrays`: AreaConfig::arrays; may be empty.
std::vector<std::string> curve_range_warnings(std::span<const UnitReport> units,
                                              const std::map<std::string, Band>& events,
                                              const std::map<std::string, Band>& arrays);

}  // namespace sim
