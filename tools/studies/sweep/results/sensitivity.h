#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Caveat of shares over points of which some combinations of values are not there.
inline constexpr const char* kNoGrid = "no full grid: shares are estimates";

/// Influence of an axis on a metric: its main effect, all other axes averaged.
struct Effect {
  std::string axis;                 ///< axes that always move together are one: "a + b"
  std::vector<std::string> levels;  ///< its values, or groups of neighbours among them
  std::vector<double> means;        ///< mean of the metric at each level
  double range = 0;                 ///< from the lowest mean to the highest, over the mean of all
  double share = 0;                 ///< share of the variance, 0 to 1, what noise explains taken off
  double low = 0, high = 0;         ///< 95 % interval of the share, by noise
  std::vector<std::size_t> at;      ///< level of each point
  std::string interval_text() const;
};

struct Sensitivity {
  std::string metric;
  std::size_t points = 0;
  double mean = 0;
  bool varies = false;
  bool is_grid = true;          ///< every combination of values is there: shares are exact
  std::vector<Effect> effects;  ///< the largest share first
  double noise = 0;             ///< share of the variance that noise explains
  std::string noise_text;       ///< how that is known; empty for a figure without noise
  /// Share of the variance that axes cause only together.
  double rest() const;
};

/// Effects of all axes that vary on a metric, over the points that `may` be and have it. On a full grid the shares are
/// the first-order terms of an analysis of variance. Otherwise (subsets, failed points) an additive model is fitted by
/// least squares, values of an axis that hardly any two points share are taken together in groups, and what chance
/// alone would explain is taken off the shares. Noise of the points (figure_noise.h) is taken off, too; intervals
/// are those of sweeps drawn about the points' values. InputError if the metric is no number.
Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& may);

/// `metrics` empty: the usual ones. `band`: for metrics that follow from energy, which entries of the tables decide the
/// ranking, too.
std::string sensitivity_text(const Results& results, std::vector<std::string> metrics,
                             const std::vector<std::string>& where, bool band = false);

}  // namespace tools::results
