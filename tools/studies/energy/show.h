#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"

namespace tools {

/// Entries of a configuration's energy tables: bands, curves over size, where each figure comes from and what counts
/// it. `name` is an entry, the end of one or the group before a dot; empty: all. InputError if there is none.
std::string energy_show(const JobOptions& options, const std::string& name);

/// Entries by the shortest of their names, as energy_show() takes them.
std::vector<std::string> energy_names(const JobOptions& options);

}  // namespace tools
