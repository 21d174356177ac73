#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

inline constexpr std::uint64_t kEnergyDraws = 2000, kEnergySeed = 1;

/// Block name that selects the energy of a whole frame period at frame.fps (PricedRun::period_energy_pj) instead of a
/// block's.
inline constexpr std::string_view kPeriod = "(period)";

/// A figure of a report that is proportional to energy or to its inverse.
struct EnergyMetric {
  std::string block;     ///< kPeriod, or the name of a block; empty: all blocks
  bool inverse = false;  ///< true: the figure is divided by energy, like frames per joule
  bool is_better(double a, double b) const { return inverse ? a > b : a < b; }
};
/// Returns how the figure at a report path depends on energy. Accepts totals.energy_mj.nominal, other energies and
/// powers, and figures of totals.perf that contain joules; returns nullopt for other paths.
std::optional<EnergyMetric> energy_metric(std::string_view path);
/// List of the figures that energy_metric() accepts, for error messages.
inline constexpr std::string_view kEnergyMetrics =
    "energy_mj.nominal, power_w.nominal, power_at_fps_w.nominal, nj_per_ray, frames_per_joule_gpu, "
    "frames_per_joule_tni, "
    "frames_per_joule_per_mm2, energy_by_block_mj.BLOCK.nominal";

/// Returns the energy in pJ of a block (of all blocks for an empty name) under each random draw of the energy tables.
/// Restores the nominal tables afterwards.
std::vector<double> energy_by_draw_pj(PricedRun& run, const std::string& block, std::uint64_t draws = kEnergyDraws,
                                      std::uint64_t seed = kEnergySeed);

/// Median and 95 % interval of samples: quantiles with linear interpolation.
struct Interval95 {
  double from = 0, median = 0, to = 0;
};
Interval95 interval_of(std::vector<double> samples);

/// Energy of run b divided by the energy of run a.
struct EnergyRatio {
  sim::Band together;  ///< ratio of the energies of both runs under the low, nominal or high tables
  Interval95 drawn;    ///< ratio over random draws of all table entries
  double b_less = 0;   ///< share of the draws in which b uses less energy
};
EnergyRatio energy_ratio(PricedRun& a, PricedRun& b, const std::string& block);

/// Energy ratio of two runs with one table entry at its low or high value and all other entries nominal.
struct TornadoBar {
  std::string entry;
  double at_low = 0, at_high = 0;
  double ratio_swing() const;
};
/// Returns a bar of the tornado chart for each table entry that changes the energy ratio of two runs, the largest
/// change first. `block`: block whose energies are compared; empty: all blocks.
std::vector<TornadoBar> tornado_bars(PricedRun& a, PricedRun& b, const std::string& block);

/// Returns the names of the energy table entries that at least one run has, in order of first appearance.
std::vector<std::string> entries_of(const std::vector<PricedRun*>& runs);
/// Sets one energy table entry of a run to a quantile of its band and all other entries to nominal.
void set_single_entry(PricedRun& run, const std::string& entry, double quantile);
/// Returns the energy in pJ of a block under the low or high energy tables; an empty name means all blocks.
double band_energy_pj(const PricedRun& run, const std::string& block, sim::BandMember member);
/// Returns the energy in pJ of a block under the current nominal figures; an empty name means all blocks.
double nominal_energy_pj(const PricedRun& run, const std::string& block);

}  // namespace tools
