#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/pricing/priced_run.h"
#include "tools/run/frame/job_options.h"

namespace tools {

/// Describes entries of a configuration's energy tables: low, nominal and high value, dependence on size, source, and
/// counters that use the entry. `name`: path of an entry, the end of its path, or a group of entries; empty: all
/// entries. Throws InputError if no entry matches.
std::string describe_energy_entries(const JobOptions& options, const std::string& name);

/// Returns the names of all entries of the energy tables, in the shortest form that describe_energy_entries() accepts.
std::vector<std::string> energy_entry_names(const JobOptions& options);

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Returns, as text, the energy of runs and sweeps under their own energy tables and under the tables that `table`
/// names. `paths`: run folders, report.json files and sweep folders. Prints the number of sweep points without a result
/// to standard error. Throws InputError if the energy of a run cannot be computed.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

}  // namespace tools
