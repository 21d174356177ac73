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

/// Returns the candidates that are not significantly worse than `first`, the best one, at 5 % for all of them together;
/// ordered from the best, without `first`.
std::vector<std::size_t> find_ties(const FigureNoise& noise, bool more_is_better,
                                   const std::vector<std::size_t>& candidates, std::size_t first);

struct BestOptions {
  std::string metric;
  bool more_is_better = true;
  std::vector<std::string> where;
  bool band = false;  ///< also compute energies under random draws of the energy tables
};
/// Returns text on the point with the highest or lowest metric (of equal ones the first), its configuration and the
/// command that runs it again. `points`: all points of the sweep. Throws InputError if no point meets the conditions.
/// Over a set of workloads the best machine is found, as in select_ranked(), with its metrics on each workload.
std::string best_text(const Results& results, std::span<const sweep::Point> points, const BestOptions& options);

/// A figure of the results to minimise or maximise.
struct Objective {
  Column column;
  bool more_is_better = false;

  /// Parses "PATH", "min:PATH" or "max:PATH", where PATH may be a function over workloads. The default is the direction
  /// of the metric, min if it has none. Throws InputError for unknown paths.
  Objective(const Results& results, const std::string& text);
  /// Returns the objective's value at a point; nothing if the point has none.
  std::optional<double> value_of(std::size_t row) const;
  bool is_better(double a, double b) const { return more_is_better ? a > b : a < b; }
  std::string describe() const;
};

struct ParetoFront {
  std::vector<std::size_t> rows;   ///< rows on the front, the best x first
  std::vector<std::size_t> other;  ///< rows that have both figures and are dominated
  std::vector<std::size_t> near;   ///< rows of `other` that may be on the front, given the noise
  std::vector<bool> sure{};        ///< by `rows`: the row is on the front in spite of the noise
  /// Returns the rows of the Pareto front, followed by all others.
  std::vector<std::size_t> all_rows() const;
  /// Returns the mark of entry `i` of `rows` in the plot: a letter, or '#' if there are too many rows.
  char mark_of(std::size_t i) const;
};

/// Finds the Pareto front of the selected rows: the rows that no other row dominates.
ParetoFront find_front(const Objective& x, const Objective& y, const std::vector<bool>& selected);

/// Returns the rows of `front.other` that no other row dominates significantly, at 5 % for all comparisons of a row
/// together. `sure`: if not empty, a row dominates another only if it also does so under the random draws of the energy
/// tables.
std::vector<std::size_t> find_near_front(const Objective& x, const Objective& y, const FigureNoise& x_noise,
                                         const FigureNoise& y_noise, const ParetoFront& front,
                                         const std::function<bool(std::size_t better, std::size_t worse)>& sure);

struct ParetoOptions {
  std::string x, y;
  std::vector<std::string> where;
  bool csv = false;
  bool band = false;  ///< also compute energies under random draws of the energy tables
};
/// Returns the plot and the table of the Pareto front, or the front as CSV.
std::string pareto_text(const Results& results, const ParetoOptions& options, std::size_t width);

}  // namespace tools::results
