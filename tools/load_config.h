#pragma once
#include "tools/options.h"
#include "tools/run_config.h"

namespace tools {

/// The configuration that a run works with: the file, then the workload if --scene names one, then --set, then --scene,
/// --camera, --frames and --resolution. InputError.
RunConfig load_run_config(const JobOptions& options);

}  // namespace tools
