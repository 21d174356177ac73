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

/// Returns a metric of a report with its noise: of its replicates, or as assumed for the size of the picture and for
/// its tile sampling.
MeasuredFigure seen_figure(const ReportFile& report, const std::string& path);

/// Significance level of all tests of differences against noise.
inline constexpr double kError = 0.05;

/// Noise of a figure at some points of a sweep: measured if all of them have replicates, otherwise assumed for the size
/// of their pictures. The noise of a function over workloads follows from the noise of the machine's points.
class FigureNoise {
 public:
  FigureNoise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows);

  /// True if the figure has noise: it depends on small differences in the timing of tiles.
  bool is_noisy() const { return noisy_; }
  bool is_measured() const { return measured_; }
  /// Values of the points; means of the replicates if noise is measured.
  const Column& means() const { return means_; }
  /// Returns the number of replicates of a point; 1 if it was simulated once.
  std::size_t replicate_count(std::size_t row) const { return measured_ ? replicates_[row] : 1; }
  /// Standard error of the value of a point; 0 for a figure without noise.
  double error(std::size_t row) const { return seen_[row].standard_error(); }
  /// Half of the 95 % interval of the value of a point.
  double half_width(std::size_t row) const { return seen_[row].half_width(); }
  /// p-value of `b` better than `a` under the null hypothesis that it is not.
  double p_value_better(std::size_t b, std::size_t a, bool more_is_better) const;
  /// Returns "noise measured by 5 replicates a point" or "a noise of 2 %, assumed ...".
  std::string describe() const;

 private:
  /// Evaluates a metric over the workloads of machines from the noise of their points.
  void fold_noise(const Results& results, const Column& figure, const std::vector<std::size_t>& rows);

  bool noisy_ = false, measured_ = false;
  Column means_;
  std::vector<MeasuredFigure> seen_;     ///< figure with its noise, by row
  std::vector<std::size_t> replicates_;  ///< by row, if noise is measured
  double least_ = 0, most_ = 0;          ///< range of the assumed noise, or of the number of replicates
};

/// Returns the half-width of the 95 % interval of a point's value as text: "± 0.52 %".
std::string interval_text(const FigureNoise& noise, std::size_t row);

// Notes below a table of results; empty if there is nothing to note.

/// Names the points among `rows` with figures of energy, area or latency outside the curves of their tables.
std::string extrapolated_note(const Results& results, const std::vector<std::size_t>& rows);
/// Returns the warnings of a report about extrapolated figures.
std::vector<std::string> extrapolation_lines(const sim::Json& report);
/// States the limits of draws of the energy tables: no noise, counts of replicate 0, nominal area.
std::string energy_draws_note(const std::vector<const FigureNoise*>& figures);

}  // namespace tools::results
