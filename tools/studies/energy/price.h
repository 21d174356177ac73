#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Runs (folders or report.json files) and sweeps under another table, beside their own. Points without a result are
/// left out and counted on standard error. InputError if one cannot be priced.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

/// A figure that two tables have differently, "none" where one has none.
struct FigureChange {
  std::string name, from, to;
};
std::vector<FigureChange> figure_changes(const RunConfig& from, const RunConfig& to);

}  // namespace tools
