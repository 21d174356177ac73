#pragma once
#include <span>

#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Every figure of the tables of energy and area must be one that some counter, unit or part of the machine can use,
/// and every counter must find its figure. InputError.
void check_table_names(std::span<const sim::UnitReport> units, const RunConfig& config);

}  // namespace tools
