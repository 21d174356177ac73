#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Returns the energy of runs and sweeps under the energy tables that `table` names and under each run's own tables.
/// `paths`: run folders, report.json files and sweep folders. Points of a sweep without a result are counted on
/// standard error. Throws InputError if the energy of a run cannot be computed.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

}  // namespace tools
