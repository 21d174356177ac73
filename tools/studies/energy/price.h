#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Returns the energies of runs (folders or report.json files) and sweeps, priced with `table` and with the table of
/// each run. Points without a result are counted on standard error. Throws InputError if a run cannot be priced.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

}  // namespace tools
