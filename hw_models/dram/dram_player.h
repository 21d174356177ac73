#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hw_models/dram/dram_channel.h"

namespace hw {

/// A request of a stream: for the line that holds `address`, in the channel's own address space.
struct DramRequest {
  Addr address = 0;
  bool write = false;
  sim::Time earliest = 0;  ///< the channel does not see it before
};

/// Outcome of a stream of requests. Times count from the moment at which a request without `earliest` reaches the
/// channel.
struct DramPlay {
  std::vector<sim::Time> arrived;  ///< by request: when the channel saw it
  std::vector<sim::Time> done;     ///< by request: when the last of its data had passed the bus
  sim::Time end = 0;               ///< when the last data had passed the bus
  DramChannel::Stats stats;
  std::vector<std::pair<std::string, std::uint64_t>> why;  ///< cycles by DramCycleReason, `end` in all

  sim::Time latency(std::size_t request) const { return done[request] - arrived[request]; }
};

/// Plays the requests through one channel alone, in their order, with at most `outstanding` of them arrived and not
/// done. The channel's addresses begin at 0 and hold nothing of other channels; `fabric` is left out.
DramPlay play(DramConfig config, std::span<const DramRequest> requests, std::uint32_t outstanding);

}  // namespace hw
