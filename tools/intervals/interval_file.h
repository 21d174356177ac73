#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/counter_kind.h"
#include "sim/intervals.h"
#include "sim/unit_report.h"

namespace tools {

inline constexpr const char* kIntervalFile = "intervals.bin.zst";

/// Names of a unit's values, in their order: cycles by reason, then counters.
struct IntervalUnit {
  struct Counter {
    std::string name;
    sim::CounterKind kind = sim::CounterKind::kSum;
  };
  std::string path;  ///< "core0.tni.trv2"
  std::vector<std::string> reasons;
  std::vector<Counter> counters;
  std::size_t values() const { return reasons.size() + counters.size(); }
};
std::vector<IntervalUnit> interval_units(std::span<const sim::UnitReport> units);

/// Intervals of one frame of the picture. A value of a row is its unit's since the beginning of the frame, so that the
/// last row is what the frame came to, and the difference of two rows what has come between them.
struct IntervalFrame {
  std::uint32_t frame = 0;              ///< its number
  sim::Time length = 0, end = 0;        ///< that all intervals but the last have; the frame's
  std::size_t rows = 0, width = 0;      ///< intervals; values of all units
  std::vector<std::uint64_t> values{};  ///< row by row

  std::span<const std::uint64_t> row(std::size_t i) const { return {values.data() + i * width, width}; }
  sim::Time begin_of(std::size_t i) const { return i * length; }
  sim::Time end_of(std::size_t i) const { return i + 1 == rows ? end : (i + 1) * length; }
  /// The same with at most so many intervals: pairs of neighbours merged until there are no more.
  IntervalFrame merged(std::size_t most) const;
};

/// Contents of intervals.bin.zst (docs/intervals.md).
struct IntervalFile {
  std::vector<IntervalUnit> units;
  std::vector<IntervalFrame> frames;
};

/// For a frame of a run of so many, which share the most intervals that a run has; each may have a few.
sim::Intervals intervals_of_frame(std::uint32_t frames);

/// Packs a run's intervals frame by frame, so that no more than one frame is kept as it is.
class IntervalPacker {
 public:
  void add(std::uint32_t frame, const sim::Intervals& intervals);
  bool empty() const { return frames_ == 0; }
  /// The file's bytes.
  std::string file(std::span<const sim::UnitReport> units) const;

 private:
  std::uint32_t frames_ = 0;
  std::string packed_;
};

/// Reads a file's bytes. InputError, without its name, for what no such file has: it may be of anybody.
IntervalFile read_intervals(std::string_view bytes);

}  // namespace tools
