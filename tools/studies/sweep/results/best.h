#pragma once
#include <span>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::results {

struct BestOptions {
  std::string metric;
  bool most = true;
  std::vector<std::string> where;
  bool band = false;  ///< how sure the place is under draws of the energy tables is said, too
};

/// The point with the most or least of a metric (of equal ones the first), what it is, where its configuration is and
/// how to run it again. `points`: of the sweep. InputError if no point meets the conditions.
std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options);

}  // namespace tools::results
