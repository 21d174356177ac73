#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/tni/messages.h"

namespace hw {

/// The window of a ray dispatcher that sends rays in the order of their sort keys.
///
///   rays --> [window, sorted by key] --> smallest key at or after that of the ray sent last; at the end, from the
///   start
///
/// 1. Rays of equal keys leave in the order of their arrival.
/// 2. A ray that has waited for `timeout` cycles leaves before all others, the oldest first. It does not move the
/// position from which keys are searched.
/// 3. Insertions and removals move the entries with larger keys, each by one place.
class SortWindow {
 public:
  /// `capacity`: number of rays. `timeout`: cycles.
  SortWindow(std::uint32_t capacity, std::uint64_t timeout) : capacity_(capacity), timeout_(timeout) {
    entries_.reserve(capacity);
  }

  bool is_empty() const { return entries_.empty(); }
  bool is_full() const { return entries_.size() == capacity_; }
  std::size_t size() const { return entries_.size(); }

  /// Inserts a ray at cycle `cycle`, and returns how many entries shift to make room. The window must not be full.
  std::uint64_t insert_ray(const RayJob& job, std::uint64_t cycle);
  struct Sent {
    RayJob job;
    std::uint64_t moved = 0;  ///< number of entries that the removal moves
    bool timed_out = false;   ///< the ray is sent because of its wait
  };
  /// Removes the ray to be sent at cycle `cycle`. The window must not be empty.
  Sent remove_next(std::uint64_t cycle);

 private:
  struct Entry {
    RayJob job;
    std::uint64_t arrived = 0;  ///< cycle of the arrival
    std::uint64_t number = 0;   ///< order of arrival
  };

  const std::uint32_t capacity_;
  const std::uint64_t timeout_;
  std::vector<Entry> entries_;  ///< sorted by key, then by arrival
  std::uint32_t last_key_ = 0;  ///< key of the ray sent last in the order of keys
  std::uint64_t arrivals_ = 0;
  std::uint64_t oldest_ = 0;  ///< lower bound of the arrival cycles of all entries
};

}  // namespace hw
