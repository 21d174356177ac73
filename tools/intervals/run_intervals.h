#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/unit_report.h"
#include "tools/analysis/report_file.h"
#include "tools/intervals/interval_file.h"
#include "tools/run/frame/load_config.h"

namespace tools {

/// Intervals of a finished run, stored next to its report, with its units:
///
///   intervals.bin.zst: values by edge ──┐
///   report.json: config ──► machine at rest: blocks, reasons, what each counter costs ──► series.h: W, GB/s, %
///
/// The constructor checks that the last rows of all frames sum to the report's counters.
/// That the last rows of all frames add up to the report's own counters is checked.
class RunIntervals {
 public:
  /// True if the run has intervals. Runs with --intervals off, sampled runs, points of sweeps and runs of older
  /// versions have none.
  static bool are_beside(const ReportFile& report);
  /// Loads the intervals of a run's folder or report.json. Throws InputError if there are none, if they are damaged or
  /// belong to another report, or if the report was made by another model.
  static RunIntervals load(const std::filesystem::path& run);
  explicit RunIntervals(const ReportFile& report);

  const RunConfig& config() const { return config_; }
  /// Returns every unit at rest: path, block, reasons and counters with their events, all values 0.
  std::span<const sim::UnitReport> units() const { return units_; }
  /// Returns the frames in the order of the run.
  std::span<const IntervalFrame> frames() const { return frames_; }

  /// Sets the values of `units`, a copy of units(), to those at the end of an interval. Peaks are the maximum until
  /// then.
  static void set_until(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units);
  /// Sets the values of `units` to their increase in an interval. Peaks are the maximum since the beginning of the
  /// frame.
  static void set_within(const IntervalFrame& frame, std::size_t interval, std::span<sim::UnitReport> units);

 private:
  RunConfig config_;
  std::vector<sim::UnitReport> units_;
  std::vector<IntervalFrame> frames_;
};

}  // namespace tools
