#pragma once
#include <cstdint>

#include "sim/time.h"

namespace hw {

/// Sum of the times that items such as requests spend inside a unit, from arrival to departure.
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
  /// Returns the sum at time `now`. Items still inside count from their arrival to `now`.
  sim::Time sum_at(sim::Time now) const { return departed_ + inside_ * now - arrivals_; }

 private:
  std::uint64_t inside_ = 0;
  sim::Time arrivals_ = 0;  ///< sum of arrival times of the items inside
  sim::Time departed_ = 0;  ///< sum of the times spent inside by items that have left
};

}  // namespace hw
