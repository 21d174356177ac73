#pragma once
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"

namespace tools {

/// Describes entries of a configuration's energy tables: low, nominal and high value, dependence on size, source, and
/// counters that use the entry. `name`: path of an entry, the end of its path, or a group of entries; empty: all
/// entries. Throws InputError if no entry matches.
std::string describe_energy_entries(const JobOptions& options, const std::string& name);

/// Returns the names of all entries of the energy tables, in the shortest form that describe_energy_entries() accepts.
std::vector<std::string> energy_entry_names(const JobOptions& options);

}  // namespace tools
