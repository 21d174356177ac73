#pragma once
#include <span>

#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Throws InputError unless every entry of the tables of energy and area matches a counter, unit or part of the
/// machine, and every counter has an entry.
void check_table_names(std::span<const sim::UnitReport> units, const RunConfig& config);

}  // namespace tools
