#include "tools/analysis/limiter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "hw_models/srp/srp.h"
#include "hw_models/tni/trv.h"
#include "tools/analysis/units.h"

namespace tools {
namespace {

// Fitted to 39 random machines other than those in the tables of docs/bottleneck.md.

/// Mean share of a cache's MSHRs in use while it only waits for misses.
constexpr double kRegistersInUse = 2.0 / 3;
/// Reachable share of the data bus.
constexpr double kBusAtBest = 0.9;
/// Share of a channel's other busy time, such as row commands, that cannot overlap with data of other requests.
constexpr double kBusyWeight = 1.0 / 3;
/// Reachable share of a port's wires, given bursts of requests.
constexpr double kPortAtBest = 0.7;
/// Reachable share of test cycles of a T&I unit, given bursts of rays.
constexpr double kTestsAtBest = 0.85;
/// Fraction of the ideal gain from more ray slots that is realised.
constexpr double kSlotsGain = 0.6;
constexpr double kEndsOfTiles = 0.35, kSlotsWeight = 5;  // see never_full()

/// Times of a core's stages, each on its own.
using Stages = std::array<double, 3>;

/// Returns the time of all stages together.
double combined_time(const Stages& stages, double p) {
  const double longest = std::ranges::max(stages);
  if (longest <= 0) return 0;
  double sum = 0;
  for (const double stage : stages) sum += std::pow(std::max(stage, 0.0) / longest, p);
  return longest * std::pow(sum, 1 / p);
}

/// Returns the overlap exponent p: together(stages, p) = time.
double overlap_exponent(const Stages& stages, double time) {
  if (combined_time(stages, 1) <= time) return 1;
  double low = 1, high = 40;
  for (int i = 0; i < 60; ++i) {
    const double p = (low + high) / 2;
    (combined_time(stages, p) > time ? low : high) = p;
  }
  return low;
}

/// Returns the fraction of the T&I unit's non-full time that ideal shader cores leave. The ends of tiles always remain;
/// all remains if launches wait for ray slots while the unit has room.
double never_full(const CoreTime::Demands& d) {
  if (d.fed <= 0) return 1;
  return std::min(1.0, kEndsOfTiles + kSlotsWeight * d.no_slots * (1 - d.tracing / d.fed));
}

/// Returns the queue length at a memory without the fraction `gone` of its traffic, relative to the length with it.
/// Queue length is r / (1 - r) at utilisation r.
double queue_left(double busy, double gone) {
  constexpr double kMostBusy = 0.95;  // a finite frame has finite queues
  if (busy <= 0) return 1;
  const double r = std::min(busy, kMostBusy), left = r * (1 - gone);
  return left / (1 - left) / (r / (1 - r));
}

/// Lower bounds of the frame time from the work that remains if other resources are ideal.
struct Least {
  double memory = 0, lines = 0, wires = 0, tests = 0;
};
Least least_times(const CoreTime::Demands& d) {
  return {.memory = (1 - kBusyWeight) * d.dram_bus / kBusAtBest + kBusyWeight * d.dram_busy,
          .lines = 2 * d.l2_lines / (1 + d.l2_lines),  // half of the free MSHRs could be used as well
          .wires = d.port_lines / kPortAtBest,
          .tests = d.tests / kTestsAtBest};
}

/// Returns the stages if every ray slot fits: shorter memory queues, a less blocked L2. `tree`: miss time of the T&I
/// unit.
Stages without_spills(const CoreTime& t, double tree) {
  const double relief = t.demands.dram_queue * (1 - queue_left(t.demands.dram_busy, t.demands.spills));
  const auto saved = [&](const MissLevels& m) { return relief * (m.dram + m.blocked_share()); };
  return {t.busy_share() + t.data_misses * (1 - saved(t.data_levels)), t.demands.fed - tree * saved(t.tree_levels), 0};
}

std::string_view words_of(std::string_view resource) {
  return std::ranges::find(hw::IdealConfig::kResources, resource, &hw::IdealConfig::Resource::name)->words;
}

}  // namespace

Utilisation utilisation_of(std::span<const sim::UnitReport> units) {
  using Reason = hw::Srp::CycleReason;
  const Units<hw::Srp> srps(units);
  return {Units<hw::Trv>(units).share(hw::Trv::CycleReason::kVisiting),
          srps.share(Reason::kRunning) + srps.share(Reason::kSwitching), data_bus_share(units)};
}

std::vector<Estimate> estimate_speedups(const CoreTime& t) {
  const CoreTime::Demands& d = t.demands;
  const double time = 1 - (t.raster + t.raster_misses + t.transfers + t.no_tile);
  const double kernels = t.busy_share(), shading = kernels + t.data_misses;
  const double spilling = std::min(d.spilling, time);
  const double p = overlap_exponent({shading, d.fed, spilling}, time);
  const double tree =
      t.tracing_share() > 0 ? d.fed * t.tree_misses / t.tracing_share() : 0;  // miss time of the T&I unit
  const double ideal_tree = std::max(std::min(d.fed, d.tree_lines / kRegistersInUse), std::min(tree, d.tree_waits));
  const double ideal_data = std::min(t.data_misses, d.data_lines / kRegistersInUse);
  const double full_tracing = d.tracing + (d.fed - d.tracing) * never_full(d);

  const Least least = least_times(d);
  const double moved = least.memory * d.transfers;  // DMA traffic bypasses the caches and the L2
  const double all = std::max({least.memory, least.lines, least.wires});

  // Combined stages, and the rasteriser's miss time, without a part of the miss latencies.
  using Part = double (*)(const MissLevels&);
  const auto without = [&](Part part, double spills) {
    return combined_time(
        {kernels + t.data_misses * (1 - part(t.data_levels)), d.fed - tree * part(t.tree_levels), spills}, p);
  };
  const auto raster_without = [&](Part part) { return t.raster_misses * (1 - part(t.raster_levels)); };
  const Part everything = [](const MissLevels&) { return 1.0; };
  const Part of_l2 = [](const MissLevels& m) { return m.l2 + m.dram + m.blocked_request; };
  const Part of_dram = [](const MissLevels& m) { return m.dram + m.blocked_share(); };
  const Part of_wires = [](const MissLevels& m) { return m.wires; };

  const double moving = std::min(spilling, d.spill_lines);  // spilled slots with an ideal memory

  const Stages fitting = without_spills(t, tree);
  const double fitting_time = combined_time(fitting, p);
  const double hidden = std::clamp(fitting_time - std::ranges::max(fitting), 0.0, d.no_slots + t.banks);

  struct Rest {
    const char* resource;
    double stages, transfers, raster_misses;
    double least_time;  ///< lower bound of the frame time
  };
  const std::vector<Rest> rests = {
      {"tni", combined_time({shading, ideal_tree, spilling}, p), t.transfers, t.raster_misses, all},
      {"l1", without(everything, spilling), t.transfers, 0, std::max({all * d.records, moved, least.tests})},
      {"l2", without(of_l2, spilling), t.transfers, raster_without(of_l2), std::max({moved, least.wires, least.tests})},
      {"dram", without(of_dram, moving), spilling > 0 ? t.transfers * moving / spilling : 0, raster_without(of_dram),
       std::max(least.wires, least.tests)},
      {"srp", combined_time({ideal_data, full_tracing, spilling}, p), t.transfers, t.raster_misses, all},
      {"tile_buffer", fitting_time - kSlotsGain * hidden, 0, t.raster_misses,
       std::max((1 - d.spills) * std::max(least.memory, least.lines), least.wires)},
      {"interconnect", without(of_wires, spilling), t.transfers, raster_without(of_wires),
       std::max(least.memory, least.lines)},
  };
  std::vector<Estimate> estimates;
  for (const Rest& rest : rests) {
    // Cores that wait for the last tiles of others wait in proportion to tile times.
    const double busy = std::min(rest.stages, time) + rest.transfers + t.raster + rest.raster_misses;
    const double total = t.no_tile < 1 ? std::max(busy / (1 - t.no_tile), rest.least_time) : 1;
    estimates.push_back({rest.resource, total > 0 && total < 1 ? 1 / total : 1});
  }
  return estimates;
}

const Estimate& largest_speedup(const std::vector<Estimate>& estimates) {
  return *std::ranges::max_element(estimates, {}, &Estimate::speedup);
}

std::string limiter_text(std::vector<Estimate> estimates) {
  std::ranges::stable_sort(estimates, std::greater<>(), &Estimate::speedup);
  const Estimate &first = estimates[0], &second = estimates[1];
  if (first.speedup < 1.01) return "no single resource: none would gain 1 % if ideal";
  return fmt::format("{} (x{:.2f} if ideal; next: {}, x{:.2f})", words_of(first.resource), first.speedup,
                     words_of(second.resource), second.speedup);
}

}  // namespace tools
