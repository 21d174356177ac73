#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/pricing/priced_run.h"

namespace tools {

inline constexpr std::uint64_t kEnergyDraws = 2000, kEnergySeed = 1;

/// A figure of a report that is energy times or divided by what no table changes.
struct EnergyMetric {
  std::string block;     ///< empty: all blocks
  bool inverse = false;  ///< divided by energy: frames per joule
  bool is_better(double a, double b) const { return inverse ? a > b : a < b; }
};
/// "totals.energy_mj.nominal", "totals.energy_by_block_mj.tni.nominal", "totals.power_w.nominal" and those of
/// totals.perf that have joules in them; nothing for others.
std::optional<EnergyMetric> energy_metric(std::string_view path);
/// Figures that energy_metric() knows, in words.
inline constexpr std::string_view kEnergyMetrics =
    "energy_mj.nominal, power_w.nominal, nj_per_ray, frames_per_joule_gpu, frames_per_joule_tni, "
    "frames_per_joule_per_mm2, energy_by_block_mj.BLOCK.nominal";

/// pJ of a block, or of all for an empty name, under each draw. The run's figures are its table's again afterwards.
std::vector<double> drawn_pj(PricedRun& run, const std::string& block, std::uint64_t draws = kEnergyDraws,
                             std::uint64_t seed = kEnergySeed);

/// Quantiles of samples, with straight lines between neighbours.
struct Interval95 {
  double from = 0, median = 0, to = 0;
};
Interval95 interval_of(std::vector<double> samples);

/// Energy of run b over that of run a.
struct EnergyRatio {
  sim::Spread together;  ///< both under the low, nominal, high table
  Interval95 drawn;      ///< over draws of all entries
  double b_less = 0;     ///< share of the draws in which b takes less
};
EnergyRatio energy_ratio(PricedRun& a, PricedRun& b, const std::string& block);

/// The ratio when one entry of the tables is at its low or high and all others are nominal, in both designs.
struct TornadoBar {
  std::string entry;
  double at_low = 0, at_high = 0;
  double swing() const;
};
/// All entries that move the ratio, those that move it most first.
std::vector<TornadoBar> tornado(PricedRun& a, PricedRun& b, const std::string& block);

/// Names of the entries that at least one of the runs has, in the order of the first that has each.
std::vector<std::string> entries_of(const std::vector<PricedRun*>& runs);
/// Has an entry be at a quantile and all others nominal.
void set_alone(PricedRun& run, const std::string& entry, double quantile);
/// pJ under the nominal figures as they are now; all blocks for an empty name.
double nominal_pj(const PricedRun& run, const std::string& block);

}  // namespace tools
