#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/memory/l1_cache.h"
#include "sim/link.h"

namespace tools {

/// A client that reads lines through a first-level cache: one probe a cycle, as long as an MSHR is free.
///
///   reads, in order --> [L1: tags, MSHRs] --> request link;  response link --> fill
///
/// Its lines must all differ unless the former read of a line is over: who waits for a line is not kept.
class Reader {
 public:
  struct Read {
    hw::Addr line = 0;
    sim::Time earliest = 0;
    sim::Time asked = 0;  ///< when the cache was probed
    sim::Time there = 0;  ///< when the line was: at once if it hit
  };

  Reader(sim::Clock clock, const hw::CacheConfig& cache, std::uint16_t source, sim::Link<hw::MemRequest>& out,
         sim::Link<hw::MemResponse>& in)
      : clock_(clock), l1_(cache, source), out_(out), in_(in) {}

  void read(hw::Addr line, sim::Time earliest = 0) { reads_.push_back({line, earliest}); }
  const std::vector<Read>& reads() const { return reads_; }
  bool done() const { return finished_ == reads_.size(); }

  // As the engine sees it.
  const sim::Clock& clock() const { return clock_; }
  sim::Time tick(sim::Time now) {
    if (in_.can_pop(now)) {
      reads_[l1_.fill(in_.pop(now).line).asked_at].there = now;
      finished_ += 1;
    }
    if (may_read() && reads_[next_].earliest <= now) read_next(now);
    l1_.send(now, out_);
    const sim::Time next = clock_.after(now, 1);
    sim::Time wake = std::max(next, in_.pop_at());
    if (may_read()) wake = std::min(wake, std::max(next, clock_.edge_at_or_after(reads_[next_].earliest)));
    return std::min(wake, l1_.send_at(next, out_));
  }

 private:
  bool may_read() const { return next_ < reads_.size() && !l1_.full(); }
  void read_next(sim::Time now) {
    Read& read = reads_[next_];
    read.asked = now;
    // The cache keeps the number of the read instead of the cycle of its miss.
    if (l1_.access(read.line, 0, next_) == hw::L1Cache::Result::kHit) {
      read.there = now;
      finished_ += 1;
    }
    next_ += 1;
  }

  sim::Clock clock_;
  hw::L1Cache l1_;
  sim::Link<hw::MemRequest>& out_;
  sim::Link<hw::MemResponse>& in_;
  std::vector<Read> reads_;
  std::size_t next_ = 0, finished_ = 0;
};

}  // namespace tools
