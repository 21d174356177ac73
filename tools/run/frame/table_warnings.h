#pragma once
#include <span>
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Returns a warning for each size, clock and voltage outside the ranges of the energy, area and latency tables, and
/// one if tables are for different processes.
std::vector<std::string> technology_table_warnings(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Returns the warnings of technology_table_warnings() for all units of the configured machine, without a run.
std::vector<std::string> technology_table_warnings(const RunConfig& config);

/// Returns a warning if the tables of energy, area, voltage and latency that `config` uses are for different processes.
std::vector<std::string> process_warnings(const RunConfig& config);

/// Appends those lines of `more` that `lines` does not contain.
void add_warnings(std::vector<std::string>& lines, const std::vector<std::string>& more);

}  // namespace tools
