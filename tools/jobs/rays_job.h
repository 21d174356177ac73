#pragma once
#include "tools/simulation/job_options.h"

namespace tools {

/// `raywatt run --rays`: plays a list of rays on T&I units, caches and memory, and writes report.json (schema
/// raywatt-rays/1), report.txt and config.yaml. An interrupt leaves the rays that are finished, unless there is a
/// former run in their place. InputError, IoError, sim::Deadlock.
void run_rays(const JobOptions& options);

}  // namespace tools
