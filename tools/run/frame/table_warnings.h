#pragma once
#include <span>
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Returns a line for each size, clock and voltage outside the tables' ranges, and one if tables mix processes.
std::vector<std::string> table_warnings(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Returns the same lines for the units of the configured machine, without a run.
std::vector<std::string> table_warnings(const RunConfig& config);

/// Returns one line if the tables of energy, area, voltage and latency that `config` uses mix processes.
std::vector<std::string> process_warnings(const RunConfig& config);

/// Appends the lines that `lines` lacks.
void add_warnings(std::vector<std::string>& lines, const std::vector<std::string>& more);

}  // namespace tools
