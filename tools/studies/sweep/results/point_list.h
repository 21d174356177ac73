#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/studies/sweep/point.h"

namespace tools::results {

/// A point as tables show it.
struct ListedPoint {
  std::int64_t n = 0;
  std::string id;
  /// Name and value: its axes, then what else it says of the run and is no axis: scene, program, ...
  std::vector<std::pair<std::string, std::string>> axes;
};

std::vector<ListedPoint> list_points(std::span<const sweep::Point> points);

}  // namespace tools::results
