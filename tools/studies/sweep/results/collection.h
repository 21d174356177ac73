#pragma once
#include <array>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/point_list.h"
#include "tools/studies/sweep/results/point_state.h"

namespace tools::results {

/// All points of a sweep with what became of them, in memory.
struct Collection {
  std::vector<ListedPoint> points;
  std::vector<PointState> states;           ///< of the points; their metrics have moved into `columns`
  std::vector<std::string> axes;            ///< names, in the order in which they are first met
  std::vector<std::string> metrics;         ///< paths, likewise
  std::vector<std::vector<Value>> columns;  ///< of every metric: a value a point
};

/// Reads what a store holds of the points, on all cores. The same for any number of them.
Collection collect_points(std::vector<ListedPoint> points, const sweep::Store& store);

}  // namespace tools::results
