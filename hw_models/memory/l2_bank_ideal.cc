#include <algorithm>
#include <bit>

#include "hw_models/memory/l2_bank.h"

namespace hw {

/// An ideal bank takes any number of requests a cycle, each core's apart from the others'.
sim::Time L2Bank::tick_ideal(sim::Time now) {
  bool served = false;
  CycleReason then = CycleReason::kIdle;
  sim::Time wake = sim::kNever;
  for (std::size_t core = 0; core < ideal_.size(); ++core) {
    sim::Link<MemRequest>& in = cores_in_[core];
    sim::Link<MemResponse>&pipe = ideal_[core], &out = *cores_out_[core];
    for (; pipe.can_pop(now) && out.can_push(now); served = true) {
      out.push(now, pipe.pop(now));
      latency_ += now;
    }
    for (; in.can_pop(now) && pipe.can_push(now); served = true) {
      if (!in.front().write) latency_ -= in.pop_at();
      const MemRequest r = in.pop(now);
      if (r.write) {
        if (book_ != nullptr) book_->count(r.owner, &TileAccount::l2_writes);
        stats_.writes += 1;
        stats_.write_hits += 1;
        stats_.stored += 1;
        stats_.bytes_written += sector_bytes_ * static_cast<std::uint32_t>(std::popcount(r.sectors));
      } else {
        pipe.push(now, {r.line, r.source, r.tag});
        if (is_watched_) show_read(true, r.owner, now);
        stats_.reads += 1;
        stats_.hits += 1;
      }
    }
    if (pipe.can_pop(now)) {
      then = CycleReason::kOutputFull;
    } else if (pipe.pop_at() != sim::kNever && then == CycleReason::kIdle) {
      then = CycleReason::kLookup;
    }
    const sim::Time next = now + clock_.period();
    wake = std::min(wake, sim::opens(now, clock_.period(), in.pop_at(), pipe.push_at()));
    wake = std::min(wake, sim::opens(now, clock_.period(), pipe.pop_at(), std::max(next, out.push_at())));
  }
  activity_.spend(now, clock_.period(), served ? CycleReason::kServing : then, then);
  return wake;
}

}  // namespace hw
