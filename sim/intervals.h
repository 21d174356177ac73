#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sim/time.h"

namespace sim {

/// Record of what all units of a machine had counted by the edge of each interval of simulated time.
///
///   0 ------|------|------|------|---> end
///         row 0  row 1  row 2   ...   last row       full: every second edge goes, intervals are twice as long
///
/// A row has each unit's cycles by reason, then its counters, in the order of Machine::report(), all since the start:
/// an interval is the difference of two rows, and neighbours merge when the row between them goes. What happens at an
/// edge belongs to the interval behind it; so does a cycle that begins there.
class Intervals {
 public:
  static constexpr Time kFirstLength = 1'000 * kFemtosecondsPerNanosecond;
  static constexpr std::size_t kMost = 2048;
  static constexpr std::size_t kMostValues = 8 << 20;  ///< in all rows together

  /// At most `most` intervals, an even number; fewer if rows are long.
  explicit Intervals(Time length = kFirstLength, std::size_t most = kMost);

  // Called by the machine that is recorded.
  void begin(std::size_t width);
  Time next_edge() const { return (rows_ + 1) * length_; }
  /// The row of the next edge, to be filled.
  std::uint64_t* next_row();
  /// The last row, to be filled: that of the end of the run.
  std::uint64_t* last_row(Time end);

  Time length() const { return length_; }
  Time end() const { return end_; }
  /// Intervals so far; the last one is shorter than the others, or as long.
  std::size_t size() const { return rows_; }
  std::size_t width() const { return width_; }
  std::span<const std::uint64_t> row(std::size_t i) const { return {values_.get() + i * width_, width_}; }
  /// End of an interval.
  Time edge(std::size_t i) const { return i + 1 == rows_ && end_ != 0 ? end_ : (i + 1) * length_; }

 private:
  void merge_pairs();
  std::uint64_t* add_row();

  Time length_;
  std::size_t most_;
  std::size_t width_ = 0, rows_ = 0;
  Time end_ = 0;
  std::unique_ptr<std::uint64_t[]> values_;
};

}  // namespace sim
