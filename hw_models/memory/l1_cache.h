#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/mshr_file.h"
#include "sim/link.h"

namespace hw {

/// A read-only first-level cache of one unit: tags, miss status registers that merge, and requests waiting for the
/// way to memory. Who waits for a line is a bit mask of the unit's slots.
class L1Cache {
 public:
  enum class Result : std::uint8_t {
    kHit,
    kMiss,  ///< the slot now waits: fill() will name it
    kFull,  ///< no free miss register: nothing was noted, try again after a fill
  };

  L1Cache(const CacheConfig& config, std::uint16_t source) : tags_(config), misses_(config.mshrs), source_(source) {
    unsent_.reserve(config.mshrs);
  }

  Result access(Addr line, std::uint32_t slot) {
    if (tags_.probe(line)) return Result::kHit;
    const std::uint64_t bit = std::uint64_t{1} << slot;
    if (std::uint64_t* waiting = misses_.find(line)) {
      *waiting |= bit;
      return Result::kMiss;
    }
    if (misses_.full()) return Result::kFull;
    misses_.allocate(line) = bit;
    unsent_.push_back(line);
    return Result::kMiss;
  }

  /// The line has come; returns the slots that waited for it.
  std::uint64_t fill(Addr line) {
    tags_.fill(line);
    return misses_.release(line);
  }

  /// Sends the oldest request that has not left yet, if there is one and the link has room.
  void send(sim::Time now, sim::Link<MemRequest>& out) {
    if (unsent_.empty() || !out.can_push(now)) return;
    out.push(now, MemRequest{unsent_.front(), source_, 0, false});
    unsent_.erase(unsent_.begin());
  }
  /// When send() has something to do.
  sim::Time send_at(sim::Time next, const sim::Link<MemRequest>& out) const {
    return unsent_.empty() ? sim::kNever : std::max(next, out.push_at());
  }

  std::uint32_t outstanding() const { return misses_.size(); }
  bool full() const { return misses_.full(); }

 private:
  CacheTags tags_;
  MshrFile<std::uint64_t> misses_;
  std::vector<Addr> unsent_;
  std::uint16_t source_;
};

}  // namespace hw
