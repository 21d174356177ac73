#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "tools/noise/statistics.h"

namespace tools {

/// Figures of `totals` that races within a frame move: these, and all that lies below them. Energies by event and
/// cycles by kernel move, too, but have no noise told: they explain a figure.
inline constexpr std::array kNoisyFigures = {
    "cycles",
    "time_ms",
    "perf",
    "energy_mj",
    "energy_by_block_mj",
    "energy_by_kind_mj",
    "power_w",
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

/// Difference of two runs of one design that races alone may make in a figure of `totals`, where no replicates tell:
/// half of a 95 % interval, as a part of the figure (docs/noise.md).
double default_noise(double pixels, std::string_view figure);

/// A figure of `totals` that races move, e.g. "energy_mj.nominal".
bool is_noisy(std::string_view figure);

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

/// Noise of these replicates as default_noise() states it.
double noise_of_pair(const Draws& draws);

}  // namespace tools
