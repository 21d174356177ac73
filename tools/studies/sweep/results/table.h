#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Writes a cell of a CSV file, quoted if it contains a comma, a quote or a line end (RFC 4180). A text that begins
/// with
/// =, +, -, @, tab or carriage return and is no number gets a leading apostrophe, so that no spreadsheet runs it.
std::string csv_cell(std::string_view text);
/// Writes a line of cells, with its line end.
std::string csv_line(const std::vector<std::string>& cells);

/// Writes a column for readers: numbers with at most four digits and a common metric prefix, whole numbers in full, "-"
/// for absent values.
std::vector<std::string> shown_cells(const std::vector<Value>& values);
/// The same for some rows of a column; whole numbers of a figure have at most four digits, too.
std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows);
/// Name of the column for readers.
std::string shown_name(const Column& column);
/// Writes one number with at most four digits; whole numbers below 10,000 stay whole.
std::string number_text(double number);

struct TableOptions {
  std::vector<std::string> columns;  ///< empty: axes that vary, and the usual figures
  std::string sort;                  ///< "column" or "column:desc"; empty: order of the points
  std::vector<std::string> where;    ///< conditions; all must hold
  std::optional<std::size_t> limit;  ///< maximum number of rows
  bool csv = false;                  ///< CSV with all digits
};
/// Writes a table of the points of a sweep.
std::string results_table(const Results& results, const TableOptions& options);

/// Writes some rows of some columns under the given names.
std::string table_text(const std::vector<std::string>& names, const std::vector<Column>& columns,
                       const std::vector<std::size_t>& rows, bool csv);

}  // namespace tools::results
