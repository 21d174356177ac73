#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/index/value.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// A column for people: numbers in at most four digits, all with the metric prefix of the largest unless they are too
/// small for it; whole numbers as they are; text fit for a terminal, "-" for what is absent.
std::vector<std::string> shown_cells(const std::vector<Value>& values);
/// Some rows of a column. Counts of a figure have four digits at most, too: those of axes and points stay whole.
std::vector<std::string> shown_cells(const Column& column, const std::vector<std::size_t>& rows);
/// Name of the column for people.
std::string shown_name(const Column& column);

/// A single number of at most four digits; whole ones stay whole where these do.
std::string shown(double number);

}  // namespace tools::results
