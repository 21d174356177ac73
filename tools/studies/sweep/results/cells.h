#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/index/value.h"

namespace tools::results {

/// A column for people: real numbers with as many decimals as the smallest needs for four digits, text fit for a
/// terminal, "-" for what is absent.
std::vector<std::string> shown_cells(const std::vector<Value>& values);

/// A single number of four digits or more.
std::string shown(double number);

}  // namespace tools::results
