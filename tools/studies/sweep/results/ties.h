#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Replicates of a figure of the points of a sweep.
struct ReplicatedMetric {
  Column mean, deviation, count;
};
/// None if not all of these rows have replicates of it.
std::optional<ReplicatedMetric> replicated(const Results& results, const Column& metric,
                                           const std::vector<std::size_t>& rows);

/// Points that noise does not tell from the first.
struct Ties {
  std::vector<std::size_t> rows;  ///< without the first, from the best on
  bool measured = false;          ///< by replicates
  double assumed = 0;             ///< noise of the difference of two runs, if it is not measured
};

/// Candidates that a one-sided test at 5 % for all of them together does not hold to be worse than `first`, the best.
/// None for a figure without noise, or where there is nothing to compare.
std::optional<Ties> ties_with(const Results& results, const Column& metric, bool most,
                              const std::vector<std::size_t>& candidates, std::size_t first);

/// The ties, the first among them, with the axes in which they differ; and the values that all of them share.
std::string ties_text(const Results& results, const Column& metric, std::size_t first, const Ties& ties);

}  // namespace tools::results
