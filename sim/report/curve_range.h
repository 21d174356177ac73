#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/unit_report.h"

namespace sim {

/// Returns a warning for every kind of unit whose array is outside the sizes of its energy or area curve, where values
/// are extrapolated. `events`: EnergyConfig::events; `arrays`: AreaConfig::arrays, may be empty.
std::vector<std::string> sizes_outside_curves(std::span<const UnitReport> units,
                                              const std::map<std::string, Spread>& events,
                                              const std::map<std::string, Spread>& arrays);

}  // namespace sim
