#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "sim/io/json.h"
#include "tools/studies/energy/price.h"

namespace tools {

/// A run under two tables.
struct Priced {
  std::string run;                                          ///< path of the run or of the sweep
  std::string n{};                                          ///< number of a point of a sweep
  std::vector<std::pair<std::string, std::string>> axes{};  ///< its axes
  sim::Json own, asked;                                     ///< energy_totals_json()
  std::vector<FigureChange> changes;
  std::size_t plays = 1;                  ///< the run's; priced is the first
  std::vector<std::string> extrapolated;  ///< sizes outside the curves of the table asked for
};

/// For a terminal: each run by itself, or the points of a sweep as a table.
std::string priced_text(const std::vector<std::vector<Priced>>& groups);
/// A line a run, with all digits.
std::string priced_csv(const std::vector<Priced>& runs);
/// Schema raywatt-price/1.
std::string priced_json(const std::vector<Priced>& runs);

}  // namespace tools
