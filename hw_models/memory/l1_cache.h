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

/// A read-only first-level cache of one unit: tags, MSHRs that merge, and requests waiting for the
/// way to memory. Who waits for a line is a bit mask of the unit's slots. An ideal one holds every line.
class L1Cache {
 public:
  enum class Result : std::uint8_t {
    kHit,
    kMiss,  ///< the slot now waits: fill() will name it
    kFull,  ///< no free MSHR: nothing was noted, try again after a fill
  };

  /// A line on its way.
  struct Miss {
    std::uint64_t slots = 0;     ///< slots that wait for it
    std::uint64_t asked_at = 0;  ///< the user's cycle of the miss
  };

  L1Cache(const CacheConfig& config, std::uint16_t source, bool ideal = false)
      : tags_(config), misses_(config.mshrs), source_(source), ideal_(ideal) {}

  Result access(Addr line, std::uint32_t slot, std::uint64_t cycle = 0) {
    if (ideal_ || tags_.probe(line)) return Result::kHit;
    const std::uint64_t bit = std::uint64_t{1} << slot;
    if (Miss* miss = misses_.find(line)) {
      miss->slots |= bit;
      return Result::kMiss;
    }
    if (misses_.full()) return Result::kFull;
    ask(line, {bit, cycle}, owners_[slot]);
    return Result::kMiss;
  }

  /// access() to a line of a cache that is not ideal. False, and nothing done, if it is not here.
  bool hit(Addr line) { return tags_.probe(line); }

  /// Asks, on behalf of a slot, for a line that nobody needs yet, if it is neither here nor on its way. Needs a free
  /// MSHR.
  bool prefetch(Addr line, std::uint32_t slot, std::uint64_t cycle) {
    if (holds(line) || on_its_way(line) != nullptr) return false;
    ask(line, {0, cycle}, owners_[slot]);
    return true;
  }

  /// Attributes later requests of this slot to the given tile.
  void set_slot_tile(std::uint32_t slot, TileTag owner) { owners_[slot] = owner; }
  TileTag owner(std::uint32_t slot) const { return owners_[slot]; }

  /// The line has come: who waited for it, since when it was on its way.
  Miss fill(Addr line) {
    tags_.fill(line);
    return misses_.release(line);
  }

  /// Takes the line as read, in no time (Gpu::warm). False if it was not here.
  bool warm(Addr line) {
    if (ideal_ || tags_.probe(line)) return true;
    tags_.fill(line);
    return false;
  }

  /// Is the line here? Unlike access() this leaves no trace.
  bool holds(Addr line) const { return ideal_ || tags_.holds(line); }
  /// Has the host bring the tags that a probe for the line will look at.
  void look_ahead(Addr line) const { tags_.look_ahead(line); }
  /// nullptr if the line is not on its way.
  const Miss* on_its_way(Addr line) { return misses_.find(line); }

  /// Requests that have not left yet.
  std::size_t unsent() const { return unsent_.size(); }
  /// Sends the oldest request that has not left yet, if there is one and the link has room.
  void send(sim::Time now, sim::Link<MemRequest>& out) {
    if (unsent_.empty() || !out.can_push(now)) [[likely]]
      return;
    out.push(now, MemRequest{unsent_.front().line, source_, 0, false, kWholeLine, unsent_.front().owner});
    unsent_.pop_front();
  }
  /// When send() has something to do.
  sim::Time send_at(sim::Time next, const sim::Link<MemRequest>& out) const {
    return unsent_.empty() ? sim::kNever : std::max(next, out.push_at());
  }

  std::uint32_t outstanding() const { return misses_.size(); }
  std::uint32_t free_mshrs() const { return misses_.capacity() - misses_.size(); }
  bool full() const { return misses_.full(); }

 private:
  struct Unsent {
    Addr line = 0;
    TileTag owner = kNoTile;
  };

  static std::array<TileTag, 64> no_owners() {
    std::array<TileTag, 64> all{};
    all.fill(kNoTile);
    return all;
  }
  void ask(Addr line, Miss miss, TileTag owner) {
    misses_.allocate(line) = miss;
    unsent_.push_back({line, owner});
  }

  sim::Ring<Unsent> unsent_;
  CacheTags tags_;
  MshrFile<Miss> misses_;
  std::array<TileTag, 64> owners_ = no_owners();
  std::uint16_t source_;
  bool ideal_;
};

}  // namespace hw
