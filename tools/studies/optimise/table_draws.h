#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/pricing/priced_run.h"
#include "tools/studies/optimise/task.h"

namespace tools::optimise {

inline constexpr std::uint64_t kTableDraws = 1000;  ///< number of random draws of the energy and area tables

/// A simulated metric with its uncertainty: its noise, and its values under random draws of the energy and area tables.
struct MetricUncertainty {
  MeasuredMetric seen;
  std::vector<double> factors;  ///< by draw: value divided by the nominal one; empty: the tables do not affect it

  double factor(std::size_t draw) const { return factors.empty() ? 1 : factors[draw]; }
  /// Returns the metric, with noise, as computed with the energy and area tables of random draw number `draw`.
  MeasuredMetric at(std::size_t draw) const;
  /// Returns the value that the metric does not exceed with probability `share`.
  double quantile(double share) const;
};

/// Returns the probability that the true value of a noisy metric meets a constraint.
double probability_met(const Goal& goal, const MeasuredMetric& seen);

/// Makes random draws of a report's energy and area tables. In draw N an entry has the same quantile in every report,
/// so that reports can be compared draw by draw.
///
/// 1. Entries of energy tables are drawn independently of each other (EnergyDraw).
/// 2. The whole area has one random quantile per draw.
class TableDraws {
 public:
  explicit TableDraws(const ReportFile& report) : report_(report) {}
  /// Returns the uncertainty of a metric. `path`: full report path. Throws InputError if energy cannot be computed.
  MetricUncertainty uncertainty_of(const std::string& path, const MeasuredMetric& seen);

 private:
  const ReportFile& report_;
  std::unique_ptr<PricedRun> priced_;
  std::map<std::string, std::vector<double>> factors_;  ///< by block (EnergyMetric::block), and of the area
};

/// Returns the band of a report's metric. The report must have low, nominal and high below `path`.
sim::Band band_at(const ReportFile& report, const std::string& path);
/// Returns a quantile of the area: 0 gives the low end of the band, 1 the high end.
double area_at(const sim::Band& band, double quantile);

}  // namespace tools::optimise
