#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/intervals.h"
#include "sim/report/energy.h"
#include "sim/unit_report.h"
#include "tools/analysis/report_file.h"
#include "tools/run/frame/load_config.h"

namespace tools {

inline constexpr const char* kIntervalFile = "intervals.bin.zst";

/// Names of the values that a unit has in each interval, in order: its cycle reasons, then its counters.
struct IntervalUnit {
  struct Counter {
    std::string name;
    sim::CounterKind kind = sim::CounterKind::kSum;
  };
  std::string path;  ///< path of the unit: "core0.tni.trv2"
  std::vector<std::string> reasons;
  std::vector<Counter> counters;
  std::size_t value_count() const { return reasons.size() + counters.size(); }
};

/// Counters of all units at the end of each interval of one frame, one row per interval. Values are cumulative from the
/// start of the frame: the last row has the frame's totals.
struct IntervalFrame {
  std::uint32_t frame = 0;              ///< number of the frame
  sim::Time length = 0, end = 0;        ///< length of all intervals except the last; end of the frame
  std::size_t rows = 0, width = 0;      ///< number of intervals; number of values of all units
  std::vector<std::uint64_t> values{};  ///< cumulative values of all units, row by row

  std::span<const std::uint64_t> row(std::size_t i) const { return {values.data() + i * width, width}; }
  sim::Time interval_begin(std::size_t i) const { return i * length; }
  sim::Time interval_end(std::size_t i) const { return i + 1 == rows ? end : (i + 1) * length; }
  /// Returns a copy with at most `max_intervals` intervals, made by repeatedly merging pairs of neighbouring intervals.
  IntervalFrame with_merged_intervals(std::size_t max_intervals) const;
};

/// Contents of intervals.bin.zst (docs/intervals.md).
struct IntervalFile {
  std::vector<IntervalUnit> units;
  std::vector<IntervalFrame> frames;
};

/// Returns storage for the intervals of one frame, in a run of `frames` frames. The frames share the run's maximum
/// number of intervals.
sim::Intervals intervals_of_frame(std::uint32_t frames);

/// Packs a run's intervals frame by frame, so that at most one frame is kept unpacked.
class IntervalPacker {
 public:
  void add(std::uint32_t frame, const sim::Intervals& intervals);
  bool empty() const { return frames_ == 0; }
  /// Returns the bytes of intervals.bin.zst for the frames added so far.
  std::string file_bytes(std::span<const sim::UnitReport> units) const;

 private:
  std::uint32_t frames_ = 0;
  std::string packed_;
};

/// Parses the bytes of an intervals.bin.zst. Throws InputError, without the file's name, for all other input; the input
/// may be hostile.
IntervalFile read_intervals(std::string_view bytes);

/// Intervals of a finished run, which are stored next to its report, and the units that they belong to:
///
///   intervals.bin.zst: values at the end of each interval ──┐
///   report.json: config ──► units: blocks, reasons, energy ──► derive_table(): W, GB/s, %
///
/// The constructor checks that the last rows of all frames sum to the report's counters.
class RunIntervals {
 public:
  /// True if the folder of the report has intervals. Runs with --intervals off, sampled runs, points of sweeps and runs
  /// of older versions have none.
  static bool has_intervals(const ReportFile& report);
  /// Loads the intervals of a run's folder or report.json. Throws InputError if there are none, if they are damaged or
  /// belong to another report, or if the report was made by another model.
  static RunIntervals load(const std::filesystem::path& run);
  explicit RunIntervals(const ReportFile& report);

  const RunConfig& config() const { return config_; }
  /// Returns all units with all values 0: path, block, cycle reasons, and counters with their energy events.
  std::span<const sim::UnitReport> units() const { return units_; }
  /// Returns the frames in the order of the run.
  std::span<const IntervalFrame> frames() const { return frames_; }

  /// Sets the values of `units`, a copy of units(), to those at the end of an interval. A counter that records a peak
  /// is set to its maximum until then.
  static void set_cumulative_values(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units);
  /// Sets the values of `units` to their increase in an interval. A counter that records a peak is set to its maximum
  /// since the start of the frame.
  static void set_interval_values(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units);

 private:
  RunConfig config_;
  std::vector<sim::UnitReport> units_;
  std::vector<IntervalFrame> frames_;
};

/// A metric of a frame over time, such as a power or a hit rate.
struct IntervalSeries {
  std::string group;  ///< group, shown in one chart: "power", "bandwidth", "hit_rate", "utilisation", "stack.tni", ...
  std::string name;   ///< name within the group: "tni", "dram_read", "l1_miss"
  std::string unit;   ///< unit of the values: "W", "GB/s", "%"
  /// Values of the metric, one per interval; NaN for the hit rate of an interval without accesses.
  std::vector<double> values;
};

/// Metrics of a frame over time, by group:
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
  std::vector<IntervalSeries> series;  ///< series in the order of this list; series of a group are adjacent

  const IntervalSeries* find(std::string_view group, std::string_view name) const;
};

/// Computes the metrics of a frame over time. `side`: selects the low, nominal or high energies. Intervals are first
/// merged to at most `max_intervals`.
///
/// The energy of an interval is the difference of the cumulative energies at its end and its start. These are computed
/// from cumulative counters, like totals.energy_mj. The last one equals the frame's energy to the last bit.
IntervalTable derive_table(const RunIntervals& run, const IntervalFrame& frame,
                           sim::BandMember side = &sim::Band::nominal,
                           std::size_t max_intervals = sim::Intervals::kMost);

}  // namespace tools
