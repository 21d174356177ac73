#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tools/studies/sweep/results/index/point_state.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::results {

/// A point as tables show it.
struct ListedPoint {
  std::int64_t n = 0;
  std::string id;
  /// Name and value: its axes, then what else it says of the run and is no axis: scene, program, ...
  std::vector<std::pair<std::string, std::string>> axes;
};

std::vector<ListedPoint> list_points(std::span<const sweep::Point> points);

/// All points of a sweep with what became of them, in memory.
struct Collection {
  std::vector<ListedPoint> points;
  std::vector<PointState> states;           ///< the points' states; their metrics have moved into `columns`
  std::vector<std::string> axes;            ///< names, in the order in which they are first met
  std::vector<std::string> metrics;         ///< paths, likewise
  std::vector<std::vector<Value>> columns;  ///< one of every metric: a value a point
};

/// Reads what a store holds of the points, on all cores. The same for any number of them.
Collection collect_points(std::vector<ListedPoint> points, const sweep::Store& store);

}  // namespace tools::results
