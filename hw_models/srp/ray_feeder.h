#pragma once
#include <cstdint>
#include <vector>

#include "sim/time.h"

namespace hw {

/// A batch of rays that a shader core is sending to the T&I unit, and its progress.
struct RayFeed {
  std::uint32_t tile = 0, batch = 0;
  std::uint32_t next = 0;         ///< index of the next ray of the batch to send
  std::uint64_t after_spill = 0;  ///< the rays wait until this number of spill transfers has finished
};

/// The batches of rays that a shader core is sending to the T&I unit, and the number of the core's rays in that unit.
struct RayFeeder {
  std::vector<RayFeed> feeds;   ///< batches of rays being sent, in the order of the launches that produce them
  sim::Time next_at = 0;        ///< time at which the direct interface accepts the next ray
  std::uint64_t in_flight = 0;  ///< number of rays in the T&I unit

  void note_sent(sim::Time now) {
    idle_ = time_without_rays(now);
    in_flight += 1;
  }
  void record_return_time(sim::Time now) {
    if (--in_flight == 0) empty_since_ = now;
  }
  /// Returns the total time up to `now` in which the T&I unit had no ray.
  sim::Time time_without_rays(sim::Time now) const { return idle_ + (in_flight == 0 ? now - empty_since_ : 0); }

 private:
  sim::Time idle_ = 0;  ///< total time before `empty_since_` in which the T&I unit had no ray
  sim::Time empty_since_ = 0;
};

}  // namespace hw
