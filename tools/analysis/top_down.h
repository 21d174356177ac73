#pragma once
#include <span>
#include <string>
#include <vector>

#include "sim/io/json.h"
#include "sim/unit_report.h"

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Where a miss of a first-level cache spends its time on average; shares that sum to 1 (all 0 without misses).
struct MissLevels {
  double interconnect = 0;  ///< ports and wires, and queues in front of them
  double l2 = 0;            ///< its queues and look-ups
  double dram = 0;          ///< from the L2's miss to its fill: controller, device and fabric
  // Parts of the first two:
  double wires = 0;            ///< of `interconnect`: saved if it took a cycle each way and had room for everything
  double blocked_request = 0;  ///< of `interconnect`: queues in front of an L2 that waits for memory
  double blocked_bank = 0;     ///< of `l2`: queues inside for the same reason
  /// Time that an ideal memory, or an ideal L2, would not need queues for.
  double blocked() const { return blocked_request + blocked_bank; }
};

/// Where the time of a core goes, seen from its shader core: every cycle is in one place, shares of elapsed time.
///
///   array busy: kernels | switches | banks          array stands still: data_misses
///   array idle, rays in the T&I unit: boxes | triangles | pipes | tree_misses
///   array idle, none there, its rasteriser at work: raster | raster_misses
///   array idle, nor that: transfers (waiting for the DMA, for other tiles' borders or for tiles' turns) | no_tile
struct CoreTime {
  double kernels = 0, switches = 0, banks = 0;
  double data_misses = 0;
  double boxes = 0;        ///< traversal units put nodes into their box pipes
  double triangles = 0;    ///< rays wait for triangles that are being tested
  double pipes = 0;        ///< too few rays to fill pipelines, and what holds rays up inside the unit
  double tree_misses = 0;  ///< rays wait for node or triangle lines
  double raster = 0, raster_misses = 0;
  double transfers = 0, no_tile = 0;
  /// Time that parts of the core would need alone, as shares of the same time; they overlap with each other.
  struct Demands {
    double no_slots = 0;     ///< launches waited for ray slots of the tile buffer
    double fed = 0;          ///< rays were in the T&I unit
    double occupied = 0;     ///< time in which an average traversal unit had rays inside
    double tree_lines = 0;   ///< least time for the T&I unit's misses, all MSHRs of a cache always in use
    double tree_waits = 0;   ///< least time for its rays' waits for lines, 64 rays waiting side by side
    double tests = 0;        ///< least time for its box tests or triangle tests, whichever is longer
    double data_lines = 0;   ///< likewise for the data cache
    double l2_lines = 0;     ///< likewise for the L2
    double port_lines = 0;   ///< lines were on the wires of a core's cache port
    double dram_bus = 0;     ///< data were on the channels' buses
    double dram_busy = 0;    ///< channels were not idle, nor only waiting for the latency of their last data
    double dram_queue = 0;   ///< share of the L2's wait for a line that an idle memory would not have taken
    double transfers = 0;    ///< share of memory's lines that the DMA moved
    double spills = 0;       ///< share of memory's lines that were ray slots without room in the tile buffer
    double spilling = 0;     ///< the DMA moved such slots
    double spill_lines = 0;  ///< least time for these: their lines were on the wires of its port
    double tracing = 0;      ///< time of the T&I unit, at the pace it has with a ray in every slot
    double records = 0;      ///< share of the L2's requests that carry rays and hits through memory
  };
  Demands demands{};
  /// Levels on which the misses of its caches spent their time.
  MissLevels data_levels{}, tree_levels{}, raster_levels{};

  double busy() const { return kernels + switches + banks; }
  double tracing() const { return boxes + triangles + pipes + tree_misses; }
};

/// The view for every core, in order, and for all of them together (their mean).
struct TopDown {
  std::vector<CoreTime> cores;
  CoreTime gpu;
};
/// The part of their time in which data were on the channels' buses.
double data_bus_share(std::span<const sim::UnitReport> units);

TopDown top_down(std::span<const sim::UnitReport> units, const hw::GpuConfig& config);

sim::Json time_json(const CoreTime& time);
/// {gpu, cores[]}, each as above.
sim::Json top_down_json(const TopDown& view);
/// A line in words of what time_json() gives: "kernels 44 %, data-cache misses 30 % (DRAM 22 %, ...), ...", largest
/// first.
std::string top_down_text(const sim::Json& time);

/// A run's time_json(), and its cycles.
struct TimeInCycles {
  const sim::Json& time;
  double cycles = 0;
};
struct GrownPart {
  std::string name;   ///< in words, as in top_down_text()
  double cycles = 0;  ///< of an average core
};
/// Returns the part of the time that takes most cycles more in `after` than in `before`; empty if no part grew.
GrownPart most_grown_part(const TimeInCycles& before, const TimeInCycles& after);

}  // namespace tools
