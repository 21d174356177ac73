#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/simulation/run_job.h"

namespace tools {

/// Lines of `warnings[]` in report.json that follow from the run itself: figures that are extrapolated or hold at
/// another voltage, sampling that times more than was asked for.
std::vector<std::string> run_warnings(const RunConfig& config, std::span<const sim::UnitReport> units,
                                      const std::optional<SampledFrame>& sampled = {});

}  // namespace tools
