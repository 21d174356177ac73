#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace tools {

/// Returns the quantile of Student's t distribution for the cumulative probability `share`.
double student_t_quantile(double degrees, double share = 0.975);
/// Returns the probability that a variable of Student's t distribution exceeds `t`.
double student_t_tail(double t, double degrees);

/// Statistics of repeated measurements (draws) of a metric.
struct Draws {
  std::size_t count = 0;
  double mean = 0;
  double deviation = 0;  ///< standard deviation of one draw, with count - 1 degrees of freedom; 0 for a single draw

  /// Returns the half-width of the 95 % interval of the mean of the draws, by Student's t; 0 for a single draw.
  double half_width() const;
};
Draws draw_statistics(std::span<const double> values);

/// Difference b - a of two means with possibly unequal variances (Welch, Biometrika 1947).
struct MeanDifference {
  double value = 0;
  double error = 0;    ///< standard error of the difference
  double degrees = 1;  ///< degrees of freedom by the Welch-Satterthwaite equation

  /// Returns the half-width of the 95 % interval of the difference.
  double half_width() const { return error == 0 ? 0 : student_t_quantile(degrees) * error; }
  /// Returns the one-sided p-value: the probability of a difference at least as large as `value` if the true difference
  /// is zero.
  double one_sided_p_value() const;
};
MeanDifference difference_of(const Draws& a, const Draws& b);

/// Returns for each null hypothesis whether it is rejected, at a family-wise error rate of `error` (Holm, Scandinavian
/// Journal of Statistics 1979). `p_values`: one per hypothesis.
std::vector<bool> reject_hypotheses(std::span<const double> p_values, double error);

/// Metrics in a report's `totals` that vary with the timing of tiles. A group includes all metrics inside it. Energies
/// by event and cycles by kernel also vary, but no noise is stated for them.
inline constexpr std::array kNoisyFigures = {
    "cycles",
    "time_ms",
    "perf",
    "energy_mj",
    "energy_by_block_mj",
    "energy_by_kind_mj",
    "power_w",
    "power_at_fps_w",
    "fps_margin",
    "dram_bytes",
    "dram_bytes_by_client.caches",
    "dram_bytes_by_client.spills",
    "utilisation",
    "top_down.gpu",
    "bottleneck.estimated_speedup",
    "relative.speedup",
    "relative.dram_bytes",
    "relative.tni_power",
    "relative.tni_perf_per_watt",
    "relative.gpu_perf_per_watt",
};

/// Returns the noise to assume for a metric of `totals` without replicates (docs/noise.md): the half-width of the 95 %
/// interval of the difference of two runs of one design, as a share of the metric's value.
double default_noise(double pixels, std::string_view figure);

/// True for a metric of `totals` that varies with the timing of tiles, e.g. "energy_mj.nominal".
bool is_noisy(std::string_view figure);

/// Value of a metric for a design: the mean of replicates, or the value of one run.
struct MeasuredMetric {
  double value = 0;
  std::optional<Draws> draws{};  ///< statistics over replicates; empty for a single run
  double assumed = 0;  ///< default_noise() of the metric if there are no replicates; 0: the metric does not vary

  /// Returns the standard error of the metric's value.
  double standard_error() const;
  /// Returns the half-width of the 95 % interval of the metric's value.
  double half_width() const;
};
/// Returns the difference b - a of two measured values and its error; by Welch's test if both have replicates.
MeanDifference difference_of(const MeasuredMetric& a, const MeasuredMetric& b);

/// Returns the noise of a metric from its replicates. Like default_noise(), it is the half-width of the 95 % interval
/// of the difference of two runs, as a share of the metric's value.
double replicate_noise(const Draws& draws);

}  // namespace tools
