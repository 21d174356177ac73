#pragma once
#include <string>
#include <vector>

#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// Warning for a sweep that lacks some combinations of axis values.
inline constexpr const char* kNoGrid = "no full grid: shares are estimates";

/// Main effect of a sweep's axis on a metric, averaged over all other axes.
struct Effect {
  std::string axis;                 ///< axes that always move together are one: "a + b"
  std::vector<std::string> levels;  ///< values of the axis, or groups of neighbouring values
  std::vector<double> means;        ///< mean of the metric at each level
  double range = 0;                 ///< difference of the highest and lowest mean, divided by the mean of all points
  double share = 0;             ///< share of the variance that the axis explains, 0 to 1, without the part due to noise
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
  bool is_grid = true;          ///< every combination of axis values was simulated, so that shares are exact
  std::vector<Effect> effects;  ///< effects of the axes, the largest share first
  double noise = 0;             ///< share of the variance that noise explains
  std::string noise_text;       ///< source of the noise; empty for a metric without noise
  /// Returns the share of the metric's variance that no single axis explains.
  double share_of_interactions() const;
};

/// Computes the effect of each varying axis on a metric, over the selected points that have the metric. Throws
/// InputError if the metric is no number.
/// 1. Full grid: an analysis of variance, first-order terms only.
/// 2. Otherwise: an additive model fitted by least squares. Neighbouring values are grouped if hardly any two points
///    share one. The share that chance explains is subtracted.
/// 3. The variance due to noise is subtracted. Intervals are computed by a parametric bootstrap.
/// 4. A function over workloads: uses machines whose points are all selected, without the axis `workload`.
Sensitivity find_sensitivity(const Results& results, const std::string& metric, const std::vector<bool>& selected);

/// Returns tables with the effect of each axis on each metric. `metrics`: empty for the main metrics. `band`: also
/// lists the entries of the energy tables that change the ranking most.
std::string sensitivity_text(const Results& results, std::vector<std::string> metrics,
                             const std::vector<std::string>& where, bool band = false);

}  // namespace tools::results
