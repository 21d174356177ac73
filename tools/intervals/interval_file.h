#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/activity.h"
#include "sim/intervals.h"
#include "sim/unit_report.h"

namespace tools {

inline constexpr const char* kIntervalFile = "intervals.bin.zst";

/// Names of a unit's values in order: cycles by reason, then counters.
struct IntervalUnit {
  struct Counter {
    std::string name;
    sim::CounterKind kind = sim::CounterKind::kSum;
  };
  std::string path;  ///< "core0.tni.trv2"
  std::vector<std::string> reasons;
  std::vector<Counter> counters;
  std::size_t value_count() const { return reasons.size() + counters.size(); }
};
std::vector<IntervalUnit> interval_units(std::span<const sim::UnitReport> units);

/// Intervals of one frame of the picture. Values are cumulative from the beginning of the frame: the last row has the
/// frame's totals, and the difference of two rows is what happened between them.
struct IntervalFrame {
  std::uint32_t frame = 0;              ///< number of the frame
  sim::Time length = 0, end = 0;        ///< of all intervals but the last; of the frame
  std::size_t rows = 0, width = 0;      ///< number of intervals; number of values of all units
  std::vector<std::uint64_t> values{};  ///< row by row

  std::span<const std::uint64_t> row(std::size_t i) const { return {values.data() + i * width, width}; }
  sim::Time begin_of(std::size_t i) const { return i * length; }
  sim::Time end_of(std::size_t i) const { return i + 1 == rows ? end : (i + 1) * length; }
  /// Returns a copy with at most `most` intervals: neighbours are merged in pairs, repeatedly.
  IntervalFrame merged_to(std::size_t most) const;
};

/// Contents of intervals.bin.zst (docs/intervals.md).
struct IntervalFile {
  std::vector<IntervalUnit> units;
  std::vector<IntervalFrame> frames;
};

/// Returns an empty record for one of `frames` frames, which share the maximum number of intervals of a run; each has
/// at least a few.
sim::Intervals intervals_of_frame(std::uint32_t frames);

/// Packs a run's intervals frame by frame, so that at most one frame is kept unpacked.
class IntervalPacker {
 public:
  void add(std::uint32_t frame, const sim::Intervals& intervals);
  bool empty() const { return frames_ == 0; }
  /// Returns the file's bytes.
  std::string file_bytes(std::span<const sim::UnitReport> units) const;

 private:
  std::uint32_t frames_ = 0;
  std::string packed_;
};

/// Reads a file's bytes. Throws InputError, without the file's name, for anything that is not such a file; the input
/// may be hostile.
IntervalFile read_intervals(std::string_view bytes);

}  // namespace tools
