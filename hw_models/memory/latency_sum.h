#pragma once
#include <cstdint>

#include "sim/time.h"

namespace hw {

/// Sum of the times that items, such as requests, spend inside a unit.
class LatencySum {
 public:
  void note_arrival(sim::Time at) {
    inside_ += 1;
    arrivals_ += at;
  }
  void note_departure(sim::Time arrived, sim::Time now) {
    inside_ -= 1;
    arrivals_ -= arrived;
    departed_ += now - arrived;
  }
  /// Returns the summed latency at time `now`. Items still inside the unit count from their arrival to `now`.
  sim::Time sum_at(sim::Time now) const { return departed_ + inside_ * now - arrivals_; }

 private:
  std::uint64_t inside_ = 0;
  sim::Time arrivals_ = 0;  ///< sum of the arrival times of the items inside the unit
  sim::Time departed_ = 0;  ///< sum of the latencies of items that have left the unit
};

}  // namespace hw
