#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"
#include "tools/run/frame/load_config.h"

namespace tools::optimise {

/// Returns the paths of all numbers in a report of this machine, from a run of a tiny picture of the default scene.
/// Paths that depend on the scene may be missing (depends_on_scene()).
std::vector<std::string> probe_report_paths(RunConfig config, JobOptions options);

/// True for a report path that some scenes or frames have and others lack, such as "kernels.shade_diffuse.cycles".
bool depends_on_scene(const std::string& path);

}  // namespace tools::optimise
