#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

inline constexpr std::uint64_t kEnergyDraws = 2000, kEnergySeed = 1;

/// Stands in place of a block for the energy of a period at frame.fps (PricedRun::of_period).
inline constexpr std::string_view kPeriod = "(period)";

/// A figure of a report that is proportional to energy or to its inverse.
struct EnergyMetric {
  std::string block;     ///< empty: all blocks; kPeriod
  bool inverse = false;  ///< divided by energy: frames per joule
  bool is_better(double a, double b) const { return inverse ? a > b : a < b; }
};
/// Returns the metric of "totals.energy_mj.nominal", "totals.energy_by_block_mj.tni.nominal", "totals.power_w.nominal"
/// "totals.power_at_fps_w.nominal", and the figures of totals.perf that contain joules; none for other paths.
std::optional<EnergyMetric> energy_metric(std::string_view path);
/// Figures that energy_metric() accepts, in words.
inline constexpr std::string_view kEnergyMetrics =
    "energy_mj.nominal, power_w.nominal, power_at_fps_w.nominal, nj_per_ray, frames_per_joule_gpu, "
    "frames_per_joule_tni, "
    "frames_per_joule_per_mm2, energy_by_block_mj.BLOCK.nominal";

/// Returns the pJ of a block, or of all for an empty name, under each draw. Restores the run's own figures afterwards.
std::vector<double> drawn_pj(PricedRun& run, const std::string& block, std::uint64_t draws = kEnergyDraws,
                             std::uint64_t seed = kEnergySeed);

/// Quantiles of samples, linearly interpolated.
struct Interval95 {
  double from = 0, median = 0, to = 0;
};
Interval95 interval_of(std::vector<double> samples);

/// Energy of run b divided by that of run a.
struct EnergyRatio {
  sim::Band together;  ///< both under the low, nominal, high table
  Interval95 drawn;    ///< over draws of all entries
  double b_less = 0;   ///< share of the draws in which b uses less energy
};
EnergyRatio energy_ratio(PricedRun& a, PricedRun& b, const std::string& block);

/// The ratio with one entry of the tables at its low or high and all others nominal, in both designs.
struct TornadoBar {
  std::string entry;
  double at_low = 0, at_high = 0;
  double ratio_swing() const;
};
/// Returns all entries that change the ratio, those of the largest change first.
std::vector<TornadoBar> tornado_bars(PricedRun& a, PricedRun& b, const std::string& block);

/// Returns the names of the entries that at least one run has, in order of first appearance.
std::vector<std::string> entries_of(const std::vector<PricedRun*>& runs);
/// Sets one entry to a quantile and all others to nominal.
void set_alone(PricedRun& run, const std::string& entry, double quantile);
/// Returns the pJ of one side under the current figures; all blocks for an empty name.
double side_pj(const PricedRun& run, const std::string& block, sim::BandMember side);
/// Returns the pJ under the current nominal figures; all blocks for an empty name.
double nominal_pj(const PricedRun& run, const std::string& block);

}  // namespace tools
