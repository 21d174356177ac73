#pragma once
#include <algorithm>
#include <vector>

namespace tools {

/// Of at least one value; of an even number the mean of the two in the middle.
inline double median(std::vector<double> values) {
  std::ranges::sort(values);
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace tools
