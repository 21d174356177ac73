#include <algorithm>

#include "hw_models/dram/dram_channel.h"

namespace hw {

/// An ideal channel takes and answers all that has come.
sim::Time DramChannel::tick_ideal(sim::Time now) {
  CycleReason why = CycleReason::kIdle;
  bool blocked = false;
  sim::Time wake = sim::kNever;
  for (std::size_t port = 0; port < ports_in_.size(); ++port) {
    sim::Link<MemRequest>& in = ports_in_[port];
    sim::Link<MemResponse>& out = *ports_out_[port];
    while (in.can_pop(now) && (in.front().write || out.can_push(now))) {
      const MemRequest r = in.pop(now);
      (r.write ? stats_.writes : stats_.reads) += 1;
      (r.write ? stats_.write_bursts : stats_.read_bursts) += bursts_;
      stats_.bytes += line_bytes_;
      stats_.row_hits += 1;
      why = r.write ? CycleReason::kWriting : CycleReason::kReading;
      if (!r.write) out.push(now, {r.line, r.source, r.tag});
      if (is_watched_) show(r, now + clock_.period());
    }
    const bool stuck = in.can_pop(now);
    blocked |= stuck;
    if (stuck) wake = std::min(wake, std::max(now + clock_.period(), out.push_at()));
    if (!stuck && in.pop_at() != sim::kNever) wake = std::min(wake, in.pop_at());
  }
  const CycleReason then = blocked ? CycleReason::kReturnsFull : CycleReason::kIdle;
  activity_.spend(now, clock_.period(), why == CycleReason::kIdle ? then : why, then);
  return wake;
}

}  // namespace hw
