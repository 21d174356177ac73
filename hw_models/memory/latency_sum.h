#pragma once
#include <cstdint>

#include "sim/time.h"

namespace hw {

/// Sum of the times that items spend inside a unit, from each one's arrival to its departure.
class LatencySum {
 public:
  void arrive(sim::Time at) {
    inside_ += 1;
    arrivals_ += at;
  }
  void depart(sim::Time arrived, sim::Time now) {
    inside_ -= 1;
    arrivals_ -= arrived;
    departed_ += now - arrived;
  }
  std::uint64_t inside() const { return inside_; }
  /// Returns the sum at `now`; items still inside count up to then.
  sim::Time until(sim::Time now) const { return departed_ + inside_ * now - arrivals_; }

 private:
  std::uint64_t inside_ = 0;
  sim::Time arrivals_ = 0;  ///< of items still inside, added up
  sim::Time departed_ = 0;  ///< of items that have left
};

}  // namespace hw
