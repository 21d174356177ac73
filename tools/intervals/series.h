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
  /// One an interval. A hit rate of an interval without accesses is not a number.
  std::vector<double> values;
};

/// Figures of a frame over time.
///
/// | group | names | unit |
/// |---|---|---|
/// | `power` | blocks of the energy report, then `total` | W, on average over the interval |
/// | `power_by_kind` | `dynamic`, `clock`, `leakage`: the same sum | W |
/// | `bandwidth` | `dram_read`, `dram_write`: over the channels' buses; `l2_read`: lines that banks gave | GB/s |
/// | `hit_rate` | `node`, `triangle`, `data`: first-level caches by what they hold; `l2` | % of lookups |
/// | `utilisation` | `tni`, `srp`, `dram`, as in totals.utilisation | % of peak |
/// | `stack.tni`, `stack.ist`, `stack.srp`, `stack.dram` | reasons of traversal units, intersection units, shader cores
/// and channels | % of all their cycles; each stack sums to 100 | | `rays` | `traced`: rays that T&I units have
/// finished | Mrays/s | | `rays_in_flight` | `tni`: rays inside T&I units at the interval's end | rays |
struct IntervalTable {
  std::vector<double> begin_us, end_us;
  std::vector<IntervalSeries> series;  ///< in the order above; those of a group stand together

  const IntervalSeries* find(std::string_view group, std::string_view name) const;
};

/// By one side of the energy figures. With `most`, intervals are first merged until there are no more.
///
/// Energy of an interval is the difference of what the frame had taken by its end and by its beginning, each by the
/// arithmetic of totals.energy_mj on the counters until then; so that of the last edge has the frame's bits.
IntervalTable derive(const RunIntervals& run, const IntervalFrame& frame, sim::Side side = &sim::Spread::nominal,
                     std::size_t most = sim::Intervals::kMost);

/// pJ that each block had taken by the end of each interval, under one side's figures: one row an interval, blocks in
/// alphabetical order.
struct IntervalEnergy {
  std::vector<std::string> blocks;
  std::vector<std::vector<double>> until_pj;
};
IntervalEnergy energy_until(const RunIntervals& run, const IntervalFrame& frame,
                            sim::Side side = &sim::Spread::nominal);

}  // namespace tools
