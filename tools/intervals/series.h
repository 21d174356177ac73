#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/report/energy_table.h"
#include "tools/intervals/run_intervals.h"

namespace tools {

/// A figure over the intervals of a frame.
struct IntervalSeries {
  std::string group;  ///< "power", "bandwidth", "hit_rate", "utilisation", "stack.tni", ...: one chart each
  std::string name;   ///< "tni", "dram_read", "l1_miss"
  std::string unit;   ///< "W", "GB/s", "%"
  /// One value per interval; NaN for a hit rate of an interval without accesses.
  std::vector<double> values;
};

/// Figures of a frame over time, by group:
///
/// - `power` (W, mean over the interval): blocks of the energy report, then `total`
/// - `power_by_kind` (W): `dynamic`, `clock`, `leakage`, with the same sum
/// - `bandwidth` (GB/s): `dram_read`, `dram_write` over the channels' buses; `l2_read`: lines that banks returned
/// - `hit_rate` (% of lookups): `node`, `triangle`, `data` for first-level caches by their content; `l2`
/// - `utilisation` (% of peak): `tni`, `srp`, `dram`, as in totals.utilisation
/// - `stack.tni`, `stack.ist`, `stack.srp`, `stack.dram` (% of all their cycles): reasons of traversal units,
///   intersection units, shader cores and channels; each stack sums to 100
/// - `rays` (Mrays/s): `traced`, the rays that T&I units have finished
/// - `rays_in_flight` (rays): `tni`, the rays inside T&I units at the interval's end
struct IntervalTable {
  std::vector<double> begin_us, end_us;
  std::vector<IntervalSeries> series;  ///< in the order above; series of a group are adjacent

  const IntervalSeries* find(std::string_view group, std::string_view name) const;
};

/// Computes the table with one side of the energy figures, after merging intervals to at most `most`.
///
/// The energy of an interval is the difference of two cumulative energies, each computed as totals.energy_mj from the
/// counters until an edge. The last edge therefore gives the frame's energy bit by bit.
IntervalTable derive(const RunIntervals& run, const IntervalFrame& frame, sim::Side side = &sim::Spread::nominal,
                     std::size_t most = sim::Intervals::kMost);

/// Cumulative energy in pJ of each block at the end of each interval, under one side's figures: one row per interval,
/// blocks in alphabetical order.
struct IntervalEnergy {
  std::vector<std::string> blocks;
  std::vector<std::vector<double>> until_pj;
};
IntervalEnergy energy_until(const RunIntervals& run, const IntervalFrame& frame,
                            sim::Side side = &sim::Spread::nominal);

}  // namespace tools
