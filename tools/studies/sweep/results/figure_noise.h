#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/studies/sweep/results/results.h"

namespace sim {
class Json;
}

namespace tools::results {

/// Returns the value of a report's metric with its noise. The noise is measured by replicates, or else assumed from the
/// size of the picture and the tile sampling.
MeasuredMetric read_noisy_metric(const ReportFile& report, const std::string& path);

/// Significance level of all tests of differences against noise.
inline constexpr double kError = 0.05;

/// Noise of a metric at some points of a sweep: measured if all of them have replicates, otherwise assumed for the size
/// of their pictures. For a function over workloads it is computed from the points of a machine.
class MetricNoise {
 public:
  MetricNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows);

  /// True if the metric has noise, because it depends on small differences in the timing of tiles.
  bool is_noisy() const { return noisy_; }
  bool is_measured() const { return measured_; }
  /// The value of the metric at each point; the mean of the replicates if noise is measured.
  const Column& means() const { return means_; }
  /// Returns the number of replicates of a point; 1 if it was simulated once.
  std::size_t replicate_count(std::size_t row) const { return measured_ ? replicates_[row] : 1; }
  /// Standard error of the value of a point; 0 for a metric without noise.
  double error(std::size_t row) const { return seen_[row].standard_error(); }
  /// Half of the 95 % interval of the value of a point.
  double half_width(std::size_t row) const { return seen_[row].half_width(); }
  /// Returns the p-value of "`b` is better than `a`" under the null hypothesis that it is not.
  double p_value_better(std::size_t b, std::size_t a, bool more_is_better) const;
  /// Describes the noise: "noise measured by 5 replicates a point" or "a noise of 2 %, assumed ...".
  std::string describe() const;

 private:
  /// Computes value and noise of a function over workloads for each machine, from the noise of its points.
  void fold_noise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows);

  bool noisy_ = false, measured_ = false;
  Column means_;
  std::vector<MeasuredMetric> seen_;     ///< value with its noise, by row
  std::vector<std::size_t> replicates_;  ///< by row, if noise is measured
  double least_ = 0, most_ = 0;          ///< range of the assumed noise, or of the number of replicates
};

/// Returns the half-width of the 95 % interval of a point's value as text: "± 0.52 %".
std::string interval_text(const MetricNoise& noise, std::size_t row);

// Notes below a table of results. The text is empty if there is nothing to note.

/// Lists the points among `rows` whose energy, area or latency is extrapolated beyond the tables.
std::string extrapolated_note(const Results& results, const std::vector<std::size_t>& rows);
/// Returns a report's warnings about extrapolated energy, area or latency.
std::vector<std::string> extrapolation_lines(const sim::Json& report);
/// States what random draws of the energy tables ignore: noise, later replicates, and the uncertainty of the area.
std::string energy_draws_note(const std::vector<const MetricNoise*>& figures);

}  // namespace tools::results
