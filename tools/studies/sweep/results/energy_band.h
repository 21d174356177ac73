#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/pricing/energy_study.h"
#include "tools/studies/sweep/results/results.h"

namespace tools::results {

/// A figure of the points of a sweep, under nominal energy tables and under each draw of them.
struct BandedMetric {
  std::string name;
  bool most = false;  ///< more is better
  std::vector<std::size_t> rows;
  std::vector<double> nominal;             ///< by point
  std::vector<std::vector<double>> drawn;  ///< by point, then by draw; equal to nominal where no joules are in it
  std::vector<double> at_low, at_high;     ///< by point, under the low and the high tables

  bool is_better(double a, double b) const { return most ? a > b : a < b; }
  /// Figure of a point over that of another under the low, nominal and high tables: "0.981 / 0.975 / 0.969".
  std::string ratio_text(std::size_t point, std::size_t other) const;
  /// Points from the best to the worst under nominal tables, as indices of `rows`; of equal ones the first.
  std::vector<std::size_t> ranking() const;
};

/// Points of a sweep priced under draws of all entries of their energy tables; entries of a name are drawn together.
class EnergyBand {
 public:
  /// Prices the points that `may` be and have a report. InputError if one cannot be priced.
  EnergyBand(const Results& results, const std::vector<bool>& may);

  BandedMetric metric(const Column& column, bool most);
  /// Share of the draws in which each point is on the Pareto front of two metrics of the same points.
  static std::vector<double> shares_on_front(const BandedMetric& x, const BandedMetric& y);
  /// Best points in the order of the nominal figure, how sure each rank is, and how the others compare with the best.
  std::string best_text(const Results& results, const BandedMetric& metric) const;
  /// Entries of the tables by how much they move the best two points against each other, and the ranking of all.
  /// InputError for a figure without joules.
  std::string tornado_text(const Results& results, const BandedMetric& metric);

 private:
  std::vector<double> factors_at(const EnergyMetric& metric, const std::string& entry, double quantile);

  std::vector<std::size_t> rows_;
  std::vector<std::unique_ptr<PricedRun>> runs_;
};

}  // namespace tools::results
