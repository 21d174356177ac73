#pragma once
#include <array>
#include <optional>
#include <string>

#include "tools/noise/statistics.h"

namespace tools {

/// Figures of `totals` that races within a frame move, by their paths.
inline constexpr std::array kNoisyFigures = {
    "cycles",
    "time_ms",
    "perf.fps",
    "perf.mrays_per_s",
    "perf.frames_per_joule_gpu",
    "perf.frames_per_joule_tni",
    "perf.frames_per_joule_per_mm2",
    "perf.mrays_per_s_per_mm2",
    "perf.nj_per_ray",
    "energy_mj.nominal",
    "energy_by_block_mj.tni.nominal",
    "power_w.nominal",
    "dram_bytes",
    "utilisation.tni",
    "utilisation.srp",
    "utilisation.dram",
    "relative.speedup",
    "relative.tni_power",
    "relative.tni_perf_per_watt",
    "relative.gpu_perf_per_watt",
};

/// Difference of two runs of one design that races alone may make, where no replicates tell: half of a 95 % interval,
/// as a part of the figure.
double default_noise(double pixels);

/// A figure of `totals` that races move, e.g. "energy_mj.nominal".
bool is_noisy(const std::string& figure);

/// A figure of one run whose noise is taken to be the default's, as a draw of known deviation.
struct AssumedDraw {
  double value = 0;
  double noise = 0;  ///< default_noise()
};
MeanDifference difference_of(const AssumedDraw& a, const AssumedDraw& b);

/// A figure as it was seen of a design: the mean of replicates, or that of one run.
struct SeenFigure {
  double value = 0;
  std::optional<Draws> draws{};  ///< replicates
  double assumed = 0;            ///< default_noise() of a run without any; 0: races do not move the figure

  /// Standard deviation of the value.
  double error() const;
  /// Half of the value's 95 % interval.
  double half_width() const;
};
/// b - a; by Welch's test where both have replicates.
MeanDifference difference_of(const SeenFigure& a, const SeenFigure& b);

}  // namespace tools
