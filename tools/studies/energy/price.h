#pragma once
#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "tools/pricing/priced_run.h"

namespace tools {

enum class PriceFormat : std::uint8_t { kText, kCsv, kJson };

/// Returns the energies of runs (folders or report.json files) and sweeps under another table and under their own.
/// Points without a result are counted on standard error. InputError if one cannot be priced.
std::string price_text(const std::vector<std::filesystem::path>& paths, const PriceTable& table, PriceFormat format);

/// A value that differs between two tables; "none" if a table lacks it.
struct TableChange {
  std::string name, from, to;
};
std::vector<TableChange> table_changes(const RunConfig& from, const RunConfig& to);

/// A run priced under two tables.
struct Priced {
  std::string run;                                          ///< path of the run or sweep
  std::string n{};                                          ///< number of the point of a sweep
  std::vector<std::pair<std::string, std::string>> axes{};  ///< of the point
  sim::Json own, repriced;                                  ///< energy_totals_json()
  std::vector<TableChange> changes;
  std::size_t plays = 1;                  ///< replicates of the run; the first is priced
  std::vector<std::string> extrapolated;  ///< sizes outside of the curves of the new table
};

/// Returns text for a terminal: each run, or a table of the points of a sweep.
std::string priced_text(const std::vector<std::vector<Priced>>& groups);
/// Returns a line per run, with all digits.
std::string priced_csv(const std::vector<Priced>& runs);
/// Returns JSON, schema raywatt-price/1.
std::string priced_json(const std::vector<Priced>& runs);

}  // namespace tools
