#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::results {

/// Returns the candidates that are not significantly worse than `first`, the best one, at 5 % for all of them together;
/// from the best on, without `first`.
std::vector<std::size_t> find_ties(const FigureNoise& noise, bool most, const std::vector<std::size_t>& candidates,
                                   std::size_t first);
/// Writes the ties with the axes in which they differ, and for each axis its values among the ties and the share of the
/// variance over all candidates that it explains.
std::string ties_text(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& candidates,
                      std::size_t first, const std::vector<std::size_t>& ties);

struct BestOptions {
  std::string metric;
  bool most = true;
  std::vector<std::string> where;
  bool band = false;  ///< also price the points under draws of the energy tables
};
/// Writes the point with the highest or lowest metric (of equal ones the first), its configuration and the command that
/// runs it again. `points`: of the sweep. InputError if no point meets the conditions.
std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options);

}  // namespace tools::results
