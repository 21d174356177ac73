#pragma once
#include <nlohmann/json_fwd.hpp>

#include "tools/host/progress.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// The report of a run, without pictures: all frames of the inputs' configuration, by the program, the reference, the
/// threads and the replicates of `options`. `progress` may be null.
nlohmann::ordered_json plain_report(Inputs inputs, const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
