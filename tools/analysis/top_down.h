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

/// Mean latency of a first-level cache miss by level, as shares that sum to 1 (all 0 without misses).
struct MissLevels {
  double interconnect = 0;  ///< share of the ports and wires, and of queues before them
  double l2 = 0;            ///< share of queues and lookups in the L2
  double dram = 0;          ///< share of the time from an L2 miss to its fill: controller, device and fabric
  // Parts of `interconnect` and `l2` above:
  /// Part of the time in `interconnect` that an ideal interconnect (one cycle each way, no full queues) would save.
  double wires = 0;
  double blocked_request = 0;  ///< part of `interconnect`: queues in front of an L2 that waits for memory
  double blocked_bank = 0;     ///< part of `l2`: queues inside the L2 that wait for memory
  /// Returns the share of time in queues that an ideal memory or an ideal L2 would remove.
  double blocked_share() const { return blocked_request + blocked_bank; }
};

/// Shares of a core's elapsed time by cause, as seen by its shader core. Each cycle has exactly one cause.
///
///   array busy: kernels | switches (from kernel to kernel) | banks (conflicts in the tile buffer)
///   array stalled: data_misses (of the shader core's data cache)
///   array idle, rays in the T&I unit: boxes | triangles | pipes | tree_misses
///   array idle, no rays, rasteriser active: raster | raster_misses
///   array idle, no tile, tree builder active: build | build_misses
///   array idle otherwise: transfers (waiting for the DMA, borders of other tiles, or the order of tiles) | no_tile
struct CoreTime {
  double kernels = 0, switches = 0, banks = 0;
  double data_misses = 0;
  double boxes = 0;        ///< time in which traversal units (TRVs) issue nodes to their box pipes
  double triangles = 0;    ///< time in which rays wait for triangle tests
  double pipes = 0;        ///< time with too few rays to fill the pipelines, or with stalls inside the T&I unit
  double tree_misses = 0;  ///< time in which rays wait for node or triangle lines
  double raster = 0, raster_misses = 0;
  double build = 0, build_misses = 0;
  double transfers = 0, no_tile = 0;
  /// Times that parts of the core would need if they worked alone, as shares of the elapsed time. They can overlap.
  struct Demands {
    double no_slots = 0;    ///< time in which launches wait for ray slots of the tile buffer
    double fed = 0;         ///< time in which the T&I unit has rays
    double occupied = 0;    ///< mean time in which a traversal unit (TRV) holds rays
    double tree_lines = 0;  ///< lower bound of the time for the T&I unit's misses, with all MSHRs in use
    /// Lower bound of the time that the T&I unit's rays wait for lines, with 64 rays waiting at once.
    double tree_waits = 0;
    /// Lower bound of the time for the T&I unit's box tests or triangle tests, whichever is longer.
    double tests = 0;
    double data_lines = 0;   ///< lower bound of the time for data cache misses
    double l2_lines = 0;     ///< lower bound of the time for L2 misses
    double port_lines = 0;   ///< time in which the wires of the core's cache port carry lines
    double dram_bus = 0;     ///< time with data on the buses of the DRAM channels
    double dram_busy = 0;    ///< time in which DRAM channels are neither idle nor only waiting for their last data
    double dram_queue = 0;   ///< share of the L2's miss latency that is queueing: an idle memory would not need it
    double transfers = 0;    ///< share of the DMA in memory traffic
    double spills = 0;       ///< share of spilled ray slots in memory traffic
    double spilling = 0;     ///< time in which the DMA moves spilled ray slots
    double spill_lines = 0;  ///< lower bound of the time for spills, set by their lines on the wires of the DMA's port
    double tracing = 0;      ///< time that the T&I unit would need at the rate that it has with all ray slots in use
    double records = 0;      ///< share of L2 requests that read or write rays and hits stored in memory
  };
  Demands demands{};
  /// Miss latencies of the core's caches by level of memory.
  MissLevels data_levels{}, tree_levels{}, raster_levels{}, build_levels{};

  double busy_share() const { return kernels + switches + banks; }
  double tracing_share() const { return boxes + triangles + pipes + tree_misses; }
};

/// Time of each core by cause, in the order of the cores, and the mean over all cores.
struct TopDown {
  std::vector<CoreTime> cores;
  CoreTime gpu;
};
/// Returns the share of time in which the data buses of the DRAM channels transfer data.
double data_bus_share(std::span<const sim::UnitReport> units);

TopDown top_down(std::span<const sim::UnitReport> units, const hw::GpuConfig& config);

sim::Json time_json(const CoreTime& time);
/// Returns the times of all cores by cause as JSON {gpu, cores[]}; each entry has the form of time_json().
sim::Json top_down_json(const TopDown& view);
/// Returns the description of a path in time_json(): "tree misses: DRAM" for "tree_misses.dram".
std::string describe_time_part(const std::string& path);
/// Formats a result of time_json() as one line, largest share first: "kernels 44 %, data-cache misses 30 % (DRAM 22 %,
/// ...), ...".
std::string top_down_text(const sim::Json& time);

/// A core's time by cause (time_json()) in one run, and the run's cycles.
struct TimeInCycles {
  const sim::Json& time;
  double cycles = 0;
};
struct GrownPart {
  std::string name;   ///< name of the part of a core's time, as in top_down_text()
  double cycles = 0;  ///< growth of this part in cycles, mean over the cores
};
/// Returns the part of a core's time that grew most, in cycles, from run `before` to run `after`; empty if none grew.
GrownPart most_grown_part(const TimeInCycles& before, const TimeInCycles& after);

/// Utilisation of the main parts of the machine, as shares of time from 0 to 1.
struct Utilisation {
  double tni = 0;   ///< share of cycles in which a traversal unit (TRV) issues a node to its box pipe
  double srp = 0;   ///< share of cycles in which a shader core runs a kernel or switches to one
  double dram = 0;  ///< share of cycles with data on the bus of a DRAM channel
};
Utilisation utilisation_of(std::span<const sim::UnitReport> units);

/// Estimated speed-up of a frame if one resource of the machine were ideal.
struct Estimate {
  std::string resource;  ///< name of the resource, as in hw::IdealConfig
  double speedup = 1;
};

/// Estimates, for each resource, the speed-up of a frame if that resource were ideal, from the counters of one run.
///
/// A core is modelled as three concurrent stages: the shader core (kernels and data cache stalls), the T&I unit (rays
/// inside) and the DMA with spilled ray slots. With the stage times S, F and D and the total time T, the exponent p
/// solves S^p + F^p + D^p = T^p (1: sequential; large: the longest stage hides the others).
/// 1. An ideal resource shortens a stage by the time charged to that resource; p stays.
/// 2. A queue is charged to what it waits for: a queue before an L2 without a free MSHR is also charged to memory.
/// 3. Remaining work bounds the frame time from below: data buses, MSHRs, wires, tests.
/// 4. Time without a tile shrinks in proportion to tile times.
///
/// Not modelled: changes of hit rates and of the tile-to-core assignment.
std::vector<Estimate> estimate_speedups(const CoreTime& time);

/// Returns the estimate with the largest speed-up.
const Estimate& largest_speedup(const std::vector<Estimate>& estimates);

/// Returns one line on the resource that limits the frame.
std::string limiter_text(std::vector<Estimate> estimates);

}  // namespace tools
