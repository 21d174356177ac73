#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/mshr_file.h"
#include "sim/link.h"
#include "sim/ring.h"

namespace hw {

/// A read-only first-level cache of one unit: tags, MSHRs that merge misses, and a queue of requests to memory. Each
/// MSHR holds a bit mask of the unit's slots that wait for its line. An ideal cache hits on every line.
class L1Cache {
 public:
  enum class Result : std::uint8_t {
    kHit,
    kMiss,  ///< the line is not cached; the slot now waits until fill_line() returns it
    kFull,  ///< the line is not cached and no MSHR is free; the slot must retry after a fill
  };

  /// An outstanding miss of a first-level cache.
  struct Miss {
    std::uint64_t slots = 0;         ///< mask of the owning unit's slots that wait for the line
    std::uint64_t requested_at = 0;  ///< cycle of the miss, on the clock of the owning unit
  };

  L1Cache(const CacheConfig& config, std::uint16_t source, bool ideal = false)
      : tags_(config), misses_(config.mshrs), source_(source), ideal_(ideal) {}

  Result access_line(Addr line, std::uint32_t slot, std::uint64_t cycle = 0) {
    if (ideal_ || tags_.probe(line)) return Result::kHit;
    const std::uint64_t bit = std::uint64_t{1} << slot;
    if (Miss* miss = misses_.find_payload(line)) {
      miss->slots |= bit;
      return Result::kMiss;
    }
    if (misses_.is_full()) return Result::kFull;
    request_line(line, {bit, cycle}, slot_tiles_[slot]);
    return Result::kMiss;
  }

  /// Reads a line if it is cached. Otherwise returns false without side effects. Must not be called for ideal caches.
  bool try_hit(Addr line) { return tags_.probe(line); }

  /// Prefetches a line into the first-level cache, on behalf of a slot of the owning unit. The slot does not wait for
  /// the line. Returns false if the line is cached or already requested. Requires a free MSHR.
  bool prefetch_line(Addr line, std::uint32_t slot, std::uint64_t cycle) {
    if (has_line(line) || find_miss(line) != nullptr) return false;
    request_line(line, {0, cycle}, slot_tiles_[slot]);
    return true;
  }

  /// Attributes later memory requests of a slot to the given tile.
  void set_slot_tile(std::uint32_t slot, TileTag tile) { slot_tiles_[slot] = tile; }
  TileTag slot_tile(std::uint32_t slot) const { return slot_tiles_[slot]; }

  /// Fills a line into the first-level cache and frees its MSHR. Returns the completed miss: the slots that waited for
  /// the line, and the cycle of the miss.
  Miss fill_line(Addr line) {
    tags_.fill_line(line);
    return misses_.release(line);
  }

  /// Puts a line into the first-level cache without taking simulated time (Gpu::warm_caches). Returns true if the line
  /// was already cached.
  bool warm_line(Addr line) {
    if (ideal_ || tags_.probe(line)) return true;
    tags_.fill_line(line);
    return false;
  }

  const CacheTags& tags() const { return tags_; }
  /// Replaces the tag array, and so the lines, of the first-level cache. No miss may be outstanding.
  void set_tags(const CacheTags& tags) { tags_ = tags; }

  /// True if the line is cached. The line is not marked as used.
  bool has_line(Addr line) const { return ideal_ || tags_.has_line(line); }
  /// Prefetches the tags that a probe for the line reads into the host's cache. The simulated cache does not change.
  void prefetch_tags_on_host(Addr line) const { tags_.prefetch_tags_on_host(line); }
  /// Returns the outstanding miss of a cache line, or null if the line is not requested.
  const Miss* find_miss(Addr line) { return misses_.find_payload(line); }

  /// Returns the number of misses of the first-level cache whose memory requests have not been sent yet.
  std::size_t unsent_requests() const { return unsent_.size(); }
  /// Sends the oldest unsent request of the first-level cache to memory, if there is one and the link has room.
  void send_request(sim::Time now, sim::Link<MemRequest>& out) {
    if (unsent_.empty() || !out.can_push(now)) [[likely]]
      return;
    out.push(now, MemRequest{unsent_.front().line, source_, 0, false, kWholeLine, unsent_.front().tile});
    unsent_.pop_front();
  }
  /// Returns the earliest time, from `next` on, at which send_request() can send a request; kNever if no request is
  /// unsent. `next`: time of the unit's next cycle.
  sim::Time next_send_time(sim::Time next, const sim::Link<MemRequest>& out) const {
    return unsent_.empty() ? sim::kNever : std::max(next, out.push_at());
  }

  std::uint32_t outstanding_misses() const { return misses_.size(); }
  std::uint32_t free_mshrs() const { return misses_.capacity() - misses_.size(); }
  bool is_full() const { return misses_.is_full(); }

 private:
  struct Unsent {
    Addr line = 0;
    TileTag tile = kNoTile;
  };

  static std::array<TileTag, 64> no_tiles() {
    std::array<TileTag, 64> all{};
    all.fill(kNoTile);
    return all;
  }
  void request_line(Addr line, Miss miss, TileTag tile) {
    misses_.allocate(line) = miss;
    unsent_.push_back({line, tile});
  }

  sim::Ring<Unsent> unsent_;
  CacheTags tags_;
  MshrFile<Miss> misses_;
  std::array<TileTag, 64> slot_tiles_ = no_tiles();
  std::uint16_t source_;
  bool ideal_;
};

}  // namespace hw
