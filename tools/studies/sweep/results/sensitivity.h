#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Caveat for shares over points that lack some combinations of values.
inline constexpr const char* kNoGrid = "no full grid: shares are estimates";

/// Main effect of an axis on a metric, averaged over all other axes.
struct Effect {
  std::string axis;                 ///< axes that always move together are one: "a + b"
  std::vector<std::string> levels;  ///< its values, or groups of neighbouring values
  std::vector<double> means;        ///< mean of the metric at each level
  double range = 0;                 ///< distance of the lowest and highest mean, over the mean of all points
  double share = 0;             ///< share of the variance that the axis explains, 0 to 1, after subtraction of noise
  double low = 0, high = 0;     ///< 95 % interval of the share
  std::vector<std::size_t> at;  ///< level of each point
  std::string interval_text() const;
};

struct Sensitivity {
  std::string metric;
  std::size_t points = 0;   ///< number of points, or of machines
  bool by_machine = false;  ///< the metric is a function over workloads
  double mean = 0;
  bool varies = false;
  bool is_grid = true;          ///< every combination of values is there: shares are exact
  std::vector<Effect> effects;  ///< effects of the axes, the largest share first
  double noise = 0;             ///< share of the variance that noise explains
  std::string noise_text;       ///< source of the noise; empty for a figure without noise
  /// Share of the variance that no axis explains alone.
  double share_of_interactions() const;
};

/// Computes the effects of all axes that vary on a metric, over the selected points that have it. Throws InputError if
/// the metric is no number.
/// 1. Full grid: the first-order terms of an analysis of variance.
/// 2. Otherwise: an additive model by least squares; values that hardly any two points share are joined in groups, and
///    the share that chance explains is subtracted.
/// 3. Noise of the points is subtracted; intervals are those of a parametric bootstrap.
/// 4. A function over workloads: over the machines whose points are all selected, without the axis `workload`.
Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& selected);

/// Returns the sensitivity tables. `metrics`: empty for the usual metrics. `band`: also lists the entries of the energy
/// tables that decide the ranking.
std::string sensitivity_text(const Results& results, std::vector<std::string> metrics,
                             const std::vector<std::string>& where, bool band = false);

}  // namespace tools::results
