#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "tools/studies/sweep/results/figure_noise.h"
#include "tools/studies/sweep/results/results.h"
#include "tools/studies/sweep/spec/point.h"

namespace tools::results {

/// Returns the rows of `candidates` that are not significantly worse than `first`, the best row. They are ordered from
/// the best, without `first`. All tests together have an error of 5 %.
std::vector<std::size_t> find_ties(const MetricNoise& noise, bool more_is_better,
                                   const std::vector<std::size_t>& candidates, std::size_t first);

struct BestOptions {
  std::string metric;
  bool more_is_better = true;
  std::vector<std::string> where;
  bool band = false;  ///< also compute energies under random draws of the energy tables
};
/// Describes the point with the best value of the metric (the first of equal ones), its configuration and the command
/// that runs it again. `points`: all points of the sweep. If select_ranked() ranks machines, it describes the best
/// machine and its metrics on each workload. Throws InputError if no point meets the conditions.
std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options);

/// A metric of the results that is minimised or maximised.
struct Objective {
  Column column;
  bool more_is_better = false;

  /// Parses "PATH", "min:PATH" or "max:PATH", where PATH may be a function over workloads. A bare PATH is maximised if
  /// the metric is known to be better when larger, otherwise minimised. Throws InputError for unknown paths.
  Objective(const Results& results, const std::string& text);
  /// Returns the objective's value at a point; nothing if the point has none.
  std::optional<double> value_of(std::size_t row) const;
  bool is_better(double a, double b) const { return more_is_better ? a > b : a < b; }
  std::string describe() const;
};

struct ParetoFront {
  std::vector<std::size_t> rows;   ///< rows on the front, the best x first
  std::vector<std::size_t> other;  ///< rows that have both metrics and are dominated
  std::vector<std::size_t> near;   ///< rows of `other` that may be on the front within the noise
  std::vector<bool> sure{};        ///< per entry of `rows`: it is on the front whatever the noise
  /// Returns the rows of the Pareto front, followed by the dominated rows.
  std::vector<std::size_t> all_rows() const;
  /// Returns the mark of entry `i` of `rows` in the plot: a letter, or '#' if there are too many rows.
  char mark_of(std::size_t i) const;
};

/// Finds the Pareto front of two objectives: the selected rows that no other selected row dominates.
ParetoFront find_front(const Objective& x, const Objective& y, const std::vector<bool>& selected);

/// Returns the dominated rows (`front.other`) that no other row dominates significantly. A row's comparisons together
/// have an error of 5 %. `sure`: a row dominates only if this also returns true; may be empty.
std::vector<std::size_t> find_near_front(const Objective& x, const Objective& y, const MetricNoise& x_noise,
                                         const MetricNoise& y_noise, const ParetoFront& front,
                                         const std::function<bool(std::size_t better, std::size_t worse)>& sure);

struct ParetoOptions {
  std::string x, y;
  std::vector<std::string> where;
  bool csv = false;
  bool band = false;  ///< also compute energies under random draws of the energy tables
};
/// Returns the Pareto front as a text plot of `width` columns and a table, or as CSV.
std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width);

}  // namespace tools::results
