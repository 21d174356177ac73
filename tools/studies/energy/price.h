#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Returns, as text, the energy of runs and sweeps under their own energy tables and under the tables that `table`
/// names. `paths`: run folders, report.json files and sweep folders. Prints the number of sweep points without a result
/// to standard error. Throws InputError if the energy of a run cannot be computed.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

}  // namespace tools
