#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/figure_noise.h"

namespace tools::results {

/// Candidates that a one-sided test at 5 % for all of them together does not hold to be worse than `first`, the best;
/// from the best on, without the first.
std::vector<std::size_t> ties_with(const FigureNoise& noise, bool most, const std::vector<std::size_t>& candidates,
                                   std::size_t first);

/// The ties, the first among them, with the axes in which they differ; and for each axis which of its values tie, and
/// how much of the figure's variance over all candidates it explains.
std::string ties_text(const Results& results, const FigureNoise& noise, const std::vector<std::size_t>& candidates,
                      std::size_t first, const std::vector<std::size_t>& ties);

}  // namespace tools::results
