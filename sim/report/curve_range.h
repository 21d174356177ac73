#pragma once
#include <map>
#include <span>
#include <string>
#include <vector>

#include "sim/config/field.h"
#include "sim/unit_report.h"

namespace sim {

/// A line for every kind of unit whose array is smaller or larger than all points of the curves that its events, or its
/// area, are taken from: there the figure is extrapolated. `events`: EnergyConfig::events, `arrays`:
/// AreaConfig::arrays, which may be empty.
std::vector<std::string> sizes_outside_curves(std::span<const UnitReport> units,
                                              const std::map<std::string, Spread>& events,
                                              const std::map<std::string, Spread>& arrays);

}  // namespace sim
