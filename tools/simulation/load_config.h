#pragma once
#include "tools/simulation/job_options.h"
#include "tools/simulation/run_config.h"

namespace tools {

/// The configuration that a run works with: the file, then the workload if --scene names one, then --set, then --scene,
/// --camera, --frames and --resolution. InputError.
RunConfig load_run_config(const JobOptions& options);

// Its steps, for who loads many that differ little.
/// The file, then the workload, if `scene` names one. Not checked yet.
RunConfig load_base_config(const std::string& config, const std::string& scene);
/// What else the options say, upon that, and the checks.
RunConfig apply_options(RunConfig base, const JobOptions& options);

// Its last steps, for configurations that come from elsewhere.
void apply_ideal(RunConfig& config, const std::vector<std::string>& resources);
/// Checks limits, rules, and that there are energy figures; `origin` is where the configuration comes from.
void check_run_config(RunConfig& config, const std::string& origin);

}  // namespace tools
