#include "tools/analysis/limiter.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "hw_models/machines/ideal_config.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/trv.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

// Chosen: fitted to the measured bounds of sixty frames (fifteen scenes, twelve machines), of which they name the right
// resource for fifty-eight (tests/validation/DEVIATIONS.md).

/// Share of a cache's MSHRs in use on average when there is nothing but misses to wait for.
constexpr double kRegistersInUse = 2.0 / 3;
/// Share of the data bus that a frame's accesses reach.
constexpr double kBusAtBest = 0.9;
/// Share that is hidden of what more ray slots could hide at most.
constexpr double kSlotsGain = 0.6;
constexpr double kEndsOfTiles = 0.35, kSlotsWeight = 5;  // see never_full()

/// The time of two stages together that need `a` and `b` alone.
double together(double a, double b, double p) {
  if (a <= 0 || b <= 0) return std::max({a, b, 0.0});
  return std::pow(std::pow(a, p) + std::pow(b, p), 1 / p);
}

/// How two stages overlapped: p of together(a, b, p) = time.
double overlap(double a, double b, double time) {
  if (a <= 0 || b <= 0 || a + b <= time) return 1;
  double low = 1, high = 40;
  for (int i = 0; i < 60; ++i) {
    const double p = (low + high) / 2;
    (together(a, b, p) > time ? low : high) = p;
  }
  return low;
}

/// Ideal shader cores would not keep the T&I unit full: of the time in which it is not full, this part stays. The
/// ends of tiles always do; all of it does where launches wait for ray slots although the unit has room.
double never_full(const CoreTime::Demands& d) {
  if (d.fed <= 0) return 1;
  return std::min(1.0, kEndsOfTiles + kSlotsWeight * d.no_slots * (1 - d.tracing / d.fed));
}

/// The rest of `misses` if a part of their latency goes.
double without(double misses, double part) { return misses * (1 - part); }

std::string_view words_of(std::string_view resource) {
  return std::ranges::find(hw::IdealConfig::kResources, resource, &hw::IdealConfig::Resource::name)->words;
}

}  // namespace

Utilisation utilisation(std::span<const sim::UnitReport> units) {
  using Reason = hw::Srp::CycleReason;
  const Units<hw::Srp> srps(units);
  return {Units<hw::Trv>(units).share(hw::Trv::CycleReason::kVisiting),
          srps.share(Reason::kRunning) + srps.share(Reason::kSwitching), data_bus_share(units)};
}

std::vector<Estimate> estimate(const CoreTime& t) {
  const CoreTime::Demands& d = t.demands;
  const double time = 1 - (t.raster + t.raster_misses + t.transfers + t.no_tile);
  const double kernels = t.busy(), data = t.data_misses, shading = kernels + data;
  const double p = overlap(shading, d.fed, time);
  const double tree = t.tracing() > 0 ? d.fed * t.tree_misses / t.tracing() : 0;  // share of the T&I unit's time
  const double tracing = d.tracing + (d.fed - d.tracing) * never_full(d);
  const double memory = std::max(d.dram_bus / kBusAtBest, d.l2_lines / kRegistersInUse);
  const auto least = [](double lines, double measured) { return std::min(measured, lines / kRegistersInUse); };

  const auto levels = [&](double data_part, double tree_part) {
    return together(kernels + without(data, data_part), d.fed - tree + without(tree, tree_part), p);
  };
  const MissLevels &of_data = t.data_levels, &of_tree = t.tree_levels, &of_raster = t.raster_levels;
  // The rest of the two stages together, of the time spent on transfers, which wait for memory, and ray slots that fit
  // make none, and of the time in which the rasteriser waited for lines.
  struct Rest {
    const char* resource;
    double stages, transfers, waits = 1;  ///< waits: of raster_misses, what is left
  };
  const double more_slots = std::min(d.no_slots + t.banks, time - std::max(shading, d.fed));
  const std::vector<Rest> rests = {
      {"tni", std::max(together(shading, std::max(tree, least(d.tree_lines, d.fed)), p), memory), t.transfers},
      {"l1", std::max(levels(1, 1), memory * d.records), t.transfers, 0},
      {"l2", levels(of_data.l2 + of_data.dram, of_tree.l2 + of_tree.dram), t.transfers,
       1 - of_raster.l2 - of_raster.dram},
      {"dram", levels(of_data.dram, of_tree.dram), 0, 1 - of_raster.dram},
      {"srp", std::max(together(least(d.data_lines, data), tracing, p), memory), t.transfers},
      {"tile_buffer", time - kSlotsGain * std::max(0.0, more_slots), 0},
      {"interconnect", std::max(levels(of_data.interconnect / 2, of_tree.interconnect / 2), memory), t.transfers,
       1 - of_raster.interconnect / 2},
  };
  std::vector<Estimate> estimates;
  for (const auto& [resource, stages, transfers, waits] : rests) {
    const double total = std::min(stages, time) + t.no_tile + transfers + t.raster + waits * t.raster_misses;
    estimates.push_back({resource, total > 0 ? 1 / total : 1});
  }
  return estimates;
}

const Estimate& most(const std::vector<Estimate>& estimates) {
  return *std::ranges::max_element(estimates, {}, &Estimate::speedup);
}

std::string limiter(std::vector<Estimate> estimates) {
  std::ranges::stable_sort(estimates, std::greater<>(), &Estimate::speedup);
  const Estimate &first = estimates[0], &second = estimates[1];
  if (first.speedup < 1.01) return "nothing alone: no resource made perfect would be worth 1 %";
  return fmt::format("{} (perfect, they would be worth x{:.2f}; next are {} with x{:.2f})", words_of(first.resource),
                     first.speedup, words_of(second.resource), second.speedup);
}

}  // namespace tools
