#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace tools::results {

/// A cell of a CSV file: quoted if it has a comma, a quote or a line end (RFC 4180). A text that begins with one of
/// = + - @, tab or carriage return and is no number gets a leading apostrophe, so that no spreadsheet runs it.
std::string csv_cell(std::string_view text);

/// A line of them, with its line end.
std::string csv_line(const std::vector<std::string>& cells);

}  // namespace tools::results
