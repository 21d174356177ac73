#pragma once
#include <span>

#include <nlohmann/json_fwd.hpp>

#include "sim/report/area.h"
#include "sim/unit_report.h"
#include "tools/simulation/load_config.h"

namespace tools {

/// Adds to a report's totals the area of its machine by block and by what it is, and what the frame gives for it:
/// perf.frames_per_joule_per_mm2, perf.mrays_per_s_per_mm2. Nothing for a configuration without area figures.
void add_area(nlohmann::ordered_json& totals, std::span<const sim::UnitReport> units, const RunConfig& config);

}  // namespace tools
