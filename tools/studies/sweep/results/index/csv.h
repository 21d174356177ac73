#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tools::results {

/// A cell of a CSV file: in quotes if it holds a comma, a quote or a line end (RFC 4180).
std::string csv_cell(std::string_view text);

/// A line of them, with its line end.
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace tools::results
