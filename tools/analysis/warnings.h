#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// Returns a warning for each size outside the curves of the tables, and for each clock whose energies are for another
/// voltage.
std::vector<std::string> extrapolation_warnings(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Returns the warnings of report.json from the run itself: extrapolations, tables of different processes, sampling
/// that simulated more than requested.
std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled = {});

}  // namespace tools
