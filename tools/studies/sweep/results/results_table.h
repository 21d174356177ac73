#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

struct TableOptions {
  std::vector<std::string> columns;  ///< empty: what varies, and the usual figures
  std::string sort;                  ///< "column" or "column:desc"; empty: order of the points
  std::vector<std::string> where;    ///< conditions, all of which hold
  std::optional<std::size_t> limit;  ///< rows at most
  bool csv = false;
};

/// Rows of a sweep, for people or as CSV with all digits.
std::string results_table(const Results& results, const TableOptions& options);

/// Some rows of some columns. `names`: what the columns are called.
std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv);

}  // namespace tools::results
