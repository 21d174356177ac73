#pragma once
#include <memory>
#include <string>
#include <vector>

#include "tools/pricing/energy_study.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// The values of a metric at the points of a sweep, under nominal energy tables and under each random draw of them.
struct BandedMetric {
  std::string name, path;  ///< name for display; path in a report
  bool more_is_better = false;
  std::vector<std::size_t> rows;
  std::vector<std::vector<std::size_t>>
      runs;                                ///< by point: runs from which its value is computed; several for a machine
  std::vector<double> run_values;          ///< nominal value of each run
  std::shared_ptr<const Fold> fold;        ///< function that combines the workloads of a machine; null for points
  std::vector<double> nominal;             ///< by point
  std::vector<std::vector<double>> drawn;  ///< by point, then by draw; equal to `nominal` for a metric without energy
  std::vector<double> at_low, at_high;     ///< values by point under the low and the high tables

  bool is_better(double a, double b) const { return more_is_better ? a > b : a < b; }
  /// Returns the ratio of two points' values under the low, nominal and high tables: "0.981 / 0.975 / 0.969".
  std::string ratio_text(std::size_t point, std::size_t other) const;
  /// Returns the points from best to worst under nominal tables, as indices into `rows`.
  std::vector<std::size_t> rank_points() const;
};

/// Computes the energies of points of a sweep under random draws of all entries of their energy tables. Entries with
/// the same name have the same draw at all points.
class EnergyBand {
 public:
  /// Loads the reports of the points in `rows` (ascending), without points that have none. Throws InputError if the
  /// energy of a point cannot be computed.
  EnergyBand(const Results& results, const std::vector<std::size_t>& rows);

  /// Computes a metric of the points or machines in `rows` under nominal tables and all draws. Leaves out a row if a
  /// point that it needs was not loaded.
  BandedMetric price_metric(const Results& results, const Column& column, bool more_is_better,
                            const std::vector<std::size_t>& rows);
  /// Returns for each point the share of draws in which it is on the Pareto front of two metrics.
  static std::vector<double> shares_on_front(const BandedMetric& x, const BandedMetric& y);
  /// Returns a table of the best points by the nominal value of the metric, with the confidence of each rank.
  std::string best_text(const Results& results, const BandedMetric& metric) const;
  /// Returns a table of the energy entries that change the ranking most. Throws InputError for a metric without energy.
  std::string tornado_text(const Results& results, const BandedMetric& metric);

 private:
  std::vector<double> factors_at(const EnergyMetric& metric, const std::string& entry, double quantile);
  /// Returns the runs from which a metric's value in a row is computed; an empty list if one of them is missing.
  std::vector<std::size_t> find_runs(const Results& results, const Column& column, std::size_t row) const;

  std::vector<std::size_t> rows_;
  std::vector<std::unique_ptr<PricedRun>> runs_;
};

}  // namespace tools::results
