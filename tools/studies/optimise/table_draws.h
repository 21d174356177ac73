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

inline constexpr std::uint64_t kTableDraws = 1000;  ///< random draws of the tables of energy and area

/// Values that a figure of a simulated point may truly have, given its noise and the bands of the tables.
struct FigureSpread {
  MeasuredFigure seen;
  std::vector<double> factors;  ///< by draw of the tables: its value over the nominal one; empty: no table affects it

  double factor(std::size_t draw) const { return factors.empty() ? 1 : factors[draw]; }
  /// Returns the figure with the tables of a draw.
  MeasuredFigure at(std::size_t draw) const;
  /// Returns the value that the figure is below with probability `share`.
  double quantile(double share) const;
};

/// Returns the probability that a noisy figure meets a constraint.
double probability_met(const Goal& goal, const MeasuredFigure& seen);

/// Draws the tables of energy and area of a report. Draw N of all reports has equal quantiles of equal entries.
///
/// 1. Entries of energy tables are drawn independently of each other (EnergyDraw).
/// 2. The area has one quantile per draw, from low to high.
class TableDraws {
 public:
  explicit TableDraws(const ReportFile& report) : report_(report) {}
  /// Returns the spread of a figure of the report. `path`: full path. Throws InputError if the report cannot be priced.
  FigureSpread spread_of(const std::string& path, const MeasuredFigure& seen);

 private:
  const ReportFile& report_;
  std::unique_ptr<PricedRun> priced_;
  std::map<std::string, std::vector<double>> factors_;  ///< by block of EnergyMetric
};

/// Returns the band of a metric of a report, whose path has the members low, nominal and high.
sim::Band band_at(const ReportFile& report, const std::string& path);
/// Returns a quantile of the area within its band, from 0 at low to 1 at high.
double area_at(const sim::Band& band, double quantile);

}  // namespace tools::optimise
