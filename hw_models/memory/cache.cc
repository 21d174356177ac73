#include "hw_models/memory/cache.h"

namespace hw {

void CacheTags::renumber_use_times() {
  std::vector<std::uint32_t> times;
  for (std::size_t set = 0; set <= set_mask_; ++set) {
    times.assign(use_times_of(set), use_times_of(set) + ways_);
    std::ranges::sort(times);
    // Empty ways keep the time 0. All other times of last use are distinct.
    for (std::uint32_t way = 0; way < ways_; ++way) {
      std::uint32_t& time = use_times_of(set)[way];
      if (time != 0) time = 1 + static_cast<std::uint32_t>(std::ranges::lower_bound(times, time) - times.begin());
    }
  }
  clock_ = ways_;
}

}  // namespace hw
