#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/simulation/run_job.h"

namespace tools {

/// What a frame program traced of what was wanted, why, and what finding that out cost: totals.sampling of a report.
nlohmann::ordered_json sampling_json(const Simulation& simulation);

/// Of each tile, row by row: the share of its checked samples that were similar, and its blocks' side.
nlohmann::ordered_json tiles_json(const kernels::Sampling& sampling);

}  // namespace tools
