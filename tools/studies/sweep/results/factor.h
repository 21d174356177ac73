#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// An axis as the levels at which points stand. Levels are numbered in the order of their values.
struct Factor {
  std::string name;
  std::vector<std::string> levels;
  std::vector<std::size_t> at;  ///< level of every point
};

/// Axes of which some of the points at `rows` differ. Those that always move together are one.
struct Factors {
  std::vector<Factor> list;
  bool is_grid = false;  ///< every combination of levels is there once
};
Factors find_factors(const Results& results, const std::vector<std::size_t>& rows);

}  // namespace tools::results
