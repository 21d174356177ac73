#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"

namespace tools {

/// A line for each size outside the curves of the tables, and for each clock whose energies hold at another voltage.
std::vector<std::string> extrapolation_warnings(const RunConfig& config, std::span<const sim::UnitReport> units);

/// Lines of `warnings[]` in report.json that follow from the run itself: extrapolations, tables of two processes,
/// sampling that times more than was asked for.
std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled = {});

}  // namespace tools
