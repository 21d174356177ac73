#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/run/frame/job_options.h"
#include "tools/run/frame/load_config.h"

namespace tools::optimise {

/// Returns the paths of all numbers in a report of this machine, from a run of a tiny picture of the default scene.
/// Paths that depend on the scene may be missing (may_depend_on_scene()).
std::vector<std::string> probe_report_paths(RunConfig config, JobOptions options);

/// True if `text` may be a report path, or the end of one, that some scenes or frames have and others lack:
/// "kernels.shade_diffuse.cycles", "shade_diffuse.cycles". `paths`: those of probe_report_paths().
bool may_depend_on_scene(std::string_view text, std::span<const std::string> paths);

}  // namespace tools::optimise
