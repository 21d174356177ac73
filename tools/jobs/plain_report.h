#pragma once

#include "sim/io/json.h"
#include "tools/host/progress.h"
#include "tools/simulation/run_job.h"

namespace tools {

/// The report of a run, without pictures: all frames of the inputs' configuration, by the program, the reference, the
/// threads and the replicates of `options`. `progress` may be null.
sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
