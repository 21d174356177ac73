#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"

namespace tools {

/// Describes entries of the energy tables of a configuration: bands, curves over size, sources, and counters that use
/// them. `name`: an entry, the end of one, or a group; empty: all. Throws InputError if no entry matches.
std::string describe_energy_entries(const JobOptions& options, const std::string& name);

/// Returns the shortest names of all entries that describe_energy_entries() accepts.
std::vector<std::string> energy_entry_names(const JobOptions& options);

}  // namespace tools
