#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sim/time.h"

namespace sim {

/// Cumulative counters of all units at the end of each interval of simulated time.
///
///   0 ------|------|------|------|---> end
///         row 0  row 1  row 2   ...   last row       full: every second row is dropped, intervals are twice as long
///
/// 1. A row contains each unit's cycles by reason, then its counters, in the order of Machine::report(). All values
/// count from the start of the run.
/// 2. The values of an interval are the difference of two rows. So dropping the row between two intervals merges them.
/// 3. An event at an interval boundary, or a cycle that begins there, belongs to the later interval.
class Intervals {
 public:
  static constexpr Time kFirstLength = 1'000 * kFemtosecondsPerNanosecond;
  static constexpr std::size_t kMost = 2048;
  static constexpr std::size_t kMostValues = 8 << 20;  ///< maximum number of recorded values in all rows together

  /// `length`: initial length of intervals. `max_intervals`: maximum number of intervals, which must be even; it is
  /// reduced if rows have many values.
  explicit Intervals(Time length = kFirstLength, std::size_t max_intervals = kMost);

  // Functions with which a machine records its intervals.
  void allocate_rows(std::size_t values_per_row);
  Time next_interval_boundary() const { return (rows_ + 1) * length_; }
  /// Adds a row of counters for the next interval boundary. The caller fills the row.
  std::uint64_t* add_next_row();
  /// Adds a row of counters for the end of the run. The caller fills the row.
  std::uint64_t* add_last_row(Time end);

  Time interval_length() const { return length_; }
  Time end() const { return end_; }
  /// Returns the number of recorded intervals. The last interval may be shorter than the others.
  std::size_t size() const { return rows_; }
  std::size_t row_width() const { return width_; }
  std::span<const std::uint64_t> row(std::size_t interval) const { return {values_.get() + interval * width_, width_}; }
  /// Returns the time at which interval `interval` ends.
  Time interval_end(std::size_t interval) const {
    return interval + 1 == rows_ && end_ != 0 ? end_ : (interval + 1) * length_;
  }

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
