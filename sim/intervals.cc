#include "sim/intervals.h"

#include <algorithm>
#include <cassert>

namespace sim {

Intervals::Intervals(Time length, std::size_t max_intervals) : length_(length), most_(max_intervals) {
  assert(length > 0 && max_intervals >= 2 && max_intervals % 2 == 0);
}

void Intervals::allocate_rows(std::size_t values_per_row) {
  width_ = values_per_row;
  most_ = std::max<std::size_t>(2, std::min(most_, kMostValues / std::max<std::size_t>(values_per_row, 1)) / 2 * 2);
  values_ = std::make_unique_for_overwrite<std::uint64_t[]>(most_ * width_);
}

std::uint64_t* Intervals::add_next_row() {
  // One row is reserved for the end of the run.
  if (rows_ + 1 == most_) merge_pairs();
  return add_row();
}

std::uint64_t* Intervals::add_last_row(Time end) {
  assert(end > rows_ * length_ && end <= next_interval_boundary());
  end_ = end;
  return add_row();
}

std::uint64_t* Intervals::add_row() { return values_.get() + width_ * rows_++; }

/// Merges intervals in pairs: keeps rows 1, 3, 5, ... The number of rows was odd, so the next boundary is also a
/// boundary of the longer intervals.
void Intervals::merge_pairs() {
  rows_ /= 2;
  for (std::size_t interval = 0; interval < rows_; ++interval)
    std::ranges::copy(row(2 * interval + 1), values_.get() + interval * width_);
  length_ *= 2;
}

}  // namespace sim
