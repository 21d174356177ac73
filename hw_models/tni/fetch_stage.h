#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hw_models/memory/cache.h"
#include "hw_models/tni/tni_config.h"
#include "sim/link.h"
#include "sim/named.h"

namespace hw {

/// Counters of the fetch stage and L1 cache of a traversal or intersection unit.
struct FetchStats {
  std::uint64_t l1_accesses = 0;  ///< sum of L1 hits and misses, computed by stats()
  std::uint64_t l1_hits = 0, l1_misses = 0, l1_late = 0, l1_fills = 0, mshr_full = 0;
  std::uint64_t l1_miss_cycles = 0;
  std::uint64_t rau_fills = 0, rau_writes = 0, rau_reads = 0, rau_full = 0;
  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.l1_accesses), "probes of the L1, retries included", "tni.ray_buffer_read");
    counter(NAMED(s.l1_hits), "probes that hit", "cache.l1_read");
    counter(NAMED(s.l1_misses), "probes that missed", "cache.l1_probe");
    counter(NAMED(s.l1_late), "lines read whose first probe missed");
    counter(NAMED(s.l1_fills), "lines filled", "cache.l1_fill");
    counter(NAMED(s.mshr_full), "misses that found no free MSHR");
    counter(NAMED(s.l1_miss_cycles), "cycles from miss to line, summed over lines filled");
    counter(NAMED(s.rau_fills), "lines written to the table of waiting rays", "tni.rau_write");
    counter(NAMED(s.rau_writes), "rays or leaves added to the table of waiting rays", "tni.rau_write");
    counter(NAMED(s.rau_reads), "of these, rays or leaves resumed with their line", "tni.rau_read");
    counter(NAMED(s.rau_full), "misses that found the table of waiting rays, or their row of it, full");
  }
};

/// The fetch stage of a traversal or intersection unit, through which the unit's slots read lines from its L1. The key
/// tni.miss_handling selects how misses are handled.
///
///   slots that need a line --> [one probe at a time] --> hit: continue with the line
///            ^                        | miss
///            +--- line arrives -------+--- reorder: wait in the buffer;  bypass: through the pipe without work;
///                                          rau: wait in a table;         blocking: wait here, before all others
///
/// 1. Slots that waited for a line can read it even if it has been evicted meanwhile. So each slot makes progress,
/// however small the cache.
/// 2. With `bypass` a slot that missed goes through the unit's pipe without work and then probes again.
/// 3. With `rau`, slots that miss wait in the row of their line in the RAU table. They resume without another probe,
/// before slots that have not probed yet. A slot that finds its row full, or no free row, stalls the fetch stage. A
/// waiting slot keeps its place in the input buffer.
class FetchStage {
 public:
  /// The resource for which a slot waits: its line, an MSHR, or room in the RAU table. kNothing: the slot does not
  /// wait.
  enum class Wait : std::uint8_t { kNothing, kLine, kMshr, kTable };
  /// Returns the cycle reason of a unit whose slots wait for the resource `wait`; `otherwise` if `wait` is kNothing.
  template <class CycleReason>
  static constexpr CycleReason wait_reason(Wait wait, CycleReason otherwise) {
    switch (wait) {
      case Wait::kTable:
        return CycleReason::kRauFull;
      case Wait::kMshr:
        return CycleReason::kMshrFull;
      case Wait::kLine:
        return CycleReason::kL1Miss;
      case Wait::kNothing:
        break;
    }
    return otherwise;
  }

  /// `ready`: the unit's mask of slots that need to read a line. The fetch stage keeps a reference and updates it.
  FetchStage(const CacheConfig& cache, const TniMode& mode, std::uint16_t client, std::uint64_t& ready)
      : l1_(cache, client, mode.ideal_l1), handling_(mode.handling), rau_(mode.rau), ready_(ready) {
    filled_rau_rows_.reserve(rau_.rows);
  }
  FetchStage(const FetchStage&) = delete;
  FetchStage& operator=(const FetchStage&) = delete;

  /// Returns a mask of the slots that may probe the unit's L1 in this cycle.
  std::uint64_t issuable_slot_mask() const {
    if (handling_ <= MissHandling::kBypass) return ready_;
    const std::uint64_t first = ready_ & (served_ | resumed_);
    return (first != 0 || stalled_) ? first : ready_;
  }
  /// True while a slot that stalled or resumed after a miss has priority over all other slots of the fetch stage.
  bool is_stalled() const {
    return handling_ >= MissHandling::kRau && (stalled_ || (ready_ & (served_ | resumed_)) != 0);
  }
  bool is_bypassing() const { return handling_ == MissHandling::kBypass; }
  /// Returns the resource for which slots of the unit wait. If they wait for several, the RAU table precedes MSHRs, and
  /// MSHRs precede lines.
  Wait scarcest_wait() const {
    if (table_full_ != 0) return Wait::kTable;
    if (no_mshr_ != 0) return Wait::kMshr;
    return missing_ != 0 ? Wait::kLine : Wait::kNothing;
  }

  /// Probes the L1 for the line of a slot, which must be in issuable_slot_mask(). Clears the slot's `ready` bit. After
  /// a miss, the bit is set again when the slot may retry: by the fetch stage or, with `bypass`, by the unit.
  [[gnu::noinline]] Wait read_line(std::uint32_t slot, Addr line, std::uint64_t cycle) {
    const std::uint64_t bit = std::uint64_t{1} << slot;
    ready_ &= ~bit;
    if (handling_ != MissHandling::kReorder) clear_waits(bit);
    if ((served_ & bit) != 0) {
      served_ &= ~bit;
      count_read(bit);
      if (handling_ == MissHandling::kRau) {
        remove_from_rau_table(bit);
        return Wait::kNothing;
      }
      stats_.l1_hits += 1;
      return Wait::kNothing;
    }
    if (handling_ == MissHandling::kRau && !has_room_in_rau_table(line)) {
      late_ |= bit;
      stats_.l1_misses += 1;
      stats_.rau_full += 1;
      table_full_ = bit;
      stalled_ = true;
      return Wait::kTable;
    }
    switch (l1_.access_line(line, slot, cycle)) {
      case L1Cache::Result::kHit:
        stats_.l1_hits += 1;
        count_read(bit);
        return Wait::kNothing;
      case L1Cache::Result::kMiss:
        late_ |= bit;
        stats_.l1_misses += 1;
        missing_ |= bit;
        if (handling_ >= MissHandling::kRau) wait_after_miss(line, bit);
        return Wait::kLine;
      case L1Cache::Result::kFull:
        break;
    }
    late_ |= bit;
    stats_.l1_misses += 1;
    stats_.mshr_full += 1;
    no_mshr_ |= bit;
    stalled_ = handling_ >= MissHandling::kRau;
    return Wait::kMshr;
  }

  /// Fast path for a slot's first probe of the L1. Returns true if it hits; the caller must then clear the slot's
  /// `ready` bit. Returns false without side effects if read_line() is needed. Only for miss handling `reorder` and an
  /// L1 that is not ideal.
  bool try_first_probe_hit(std::uint64_t slot_bit_mask, Addr line) {
    if (((served_ | late_) & slot_bit_mask) != 0 || !l1_.try_hit(line)) [[unlikely]]
      return false;
    stats_.l1_hits += 1;
    return true;
  }

  /// Fills a line into the unit's L1 and sets the `ready` bits of the slots that wait for it.
  void fill_line(Addr line, std::uint64_t cycle) {
    const L1Cache::Miss miss = l1_.fill_line(line);
    stats_.l1_fills += 1;
    stats_.l1_miss_cycles += cycle - miss.requested_at;
    served_ |= miss.slots;
    if (is_bypassing()) return;
    missing_ &= ~miss.slots;
    ready_ |= miss.slots | no_mshr_;  // an MSHR is free, so slots that found none probe again
    if (handling_ != MissHandling::kReorder) unblock_waiters(line, miss.slots);
    no_mshr_ = 0;
  }

  /// Prefetches the L1 tags that a probe for the line reads into the host's cache. The simulated cache does not change.
  void prefetch_tags_on_host(Addr line) const { l1_.prefetch_tags_on_host(line); }
  bool warm_line(Addr line) { return l1_.warm_line(line); }
  const CacheTags& l1_tags() const { return l1_.tags(); }
  void set_l1_tags(const CacheTags& tags) { l1_.set_tags(tags); }
  std::size_t clear_l1() { return l1_.clear(); }

  /// True if a prefetch into the unit's L1 would leave an MSHR free for demand misses.
  bool can_prefetch() const { return l1_.free_mshrs() >= 2; }
  /// Prefetches a line into the L1 on behalf of a tile. Returns false if the line is cached or already requested.
  bool prefetch_line(Addr line, TileTag tile, std::uint64_t cycle) { return l1_.prefetch_line(line, tile, cycle); }
  /// Reads a line for the unit itself. Without a hit, fill_line() brings the line.
  L1Cache::UnitRead read_for_unit(Addr line, TileTag tile, std::uint64_t cycle) {
    return l1_.read_for_unit(line, tile, cycle);
  }
  /// Makes the L1 count what becomes of prefetched lines. try_first_probe_hit() must not be used then.
  void count_prefetches() { l1_.count_prefetches(); }
  const L1Cache::PrefetchCounts& prefetch_counts() const { return l1_.prefetch_counts(); }

  /// Makes a slot read a line for other slots too: its read counts as late if the first probe of any of them missed.
  void lead_group(std::uint32_t slot, std::uint64_t others) {
    if ((late_ & others) == 0) return;
    late_ &= ~others;
    late_ |= std::uint64_t{1} << slot;
  }
  /// Gives the line that a slot has just read to other slots, which waited for it or were ready to probe for it.
  void share_line(std::uint64_t slot_mask) {
    ready_ &= ~slot_mask;
    served_ &= ~slot_mask;
  }
  /// Makes slots wait for the line on which another slot has just missed, without probes. Only for `reorder`.
  void share_miss(std::uint64_t slot_mask, Addr line, Wait wait) {
    ready_ &= ~slot_mask;
    if (wait == Wait::kMshr) {
      no_mshr_ |= slot_mask;
    } else {
      missing_ |= slot_mask;
      l1_.add_waiting_slots(line, slot_mask);
    }
  }
  /// Returns a mask of the ray slots whose line has arrived and is held until they read it.
  std::uint64_t served_slots() const { return served_; }

  /// Attributes later memory requests of a slot to the given tile.
  void set_slot_tile(std::uint32_t slot, TileTag tile) { l1_.set_slot_tile(slot, tile); }
  TileTag slot_tile(std::uint32_t slot) const { return l1_.slot_tile(slot); }

  /// Returns the number of L1 misses whose memory requests have not been sent yet.
  std::size_t unsent_requests() const { return l1_.unsent_requests(); }
  void send_request(sim::Time now, sim::Link<MemRequest>& out) { l1_.send_request(now, out); }
  sim::Time next_send_time(sim::Time next, const sim::Link<MemRequest>& out) const {
    return l1_.next_send_time(next, out);
  }
  /// True if a line that the unit's L1 has requested from memory has not arrived.
  bool waits_for_memory() const { return l1_.outstanding_misses() != 0; }

  FetchStats stats() const {
    FetchStats all = stats_;
    all.l1_accesses = all.l1_hits + all.l1_misses;
    return all;
  }
  std::uint64_t missing_slots() const { return missing_; }
  std::uint64_t slots_without_mshr() const { return no_mshr_; }

 private:
  static constexpr Addr kAnyRow = ~Addr{0};

  /// Counts a slot's successful read of a line. The read counts as late if the slot's first probe missed.
  void count_read(std::uint64_t slot_mask) {
    stats_.l1_late += (late_ & slot_mask) != 0;
    late_ &= ~slot_mask;
  }
  /// Removes slots, which now probe again, from all masks of waiting slots.
  void clear_waits(std::uint64_t slot_mask) {
    missing_ &= ~slot_mask;
    no_mshr_ &= ~slot_mask;
    resumed_ &= ~slot_mask;
  }
  /// Makes a slot that missed wait: in a row of the RAU table (`rau`), or by stalling the fetch stage (`blocking`).
  void wait_after_miss(Addr line, std::uint64_t slot_mask);
  /// Resumes slots after the fill of a line: those that wait for an MSHR, for the line or for room in its table row.
  /// `slot_mask`: slots that waited for the line.
  void unblock_waiters(Addr line, std::uint64_t slot_mask);
  bool has_room_in_rau_table(Addr line);
  /// Removes a slot from its row of the RAU table, and frees the row if it is then empty.
  void remove_from_rau_table(std::uint64_t slot_mask);
  void resume_slots(std::uint64_t slot_mask);

  std::uint64_t late_ = 0;    ///< mask of the slots whose first probe for their line missed
  std::uint64_t served_ = 0;  ///< mask of the slots whose line has arrived and is kept for them
  FetchStats stats_;
  L1Cache l1_;
  const MissHandling handling_;
  const RauConfig rau_;
  std::uint64_t& ready_;          ///< mask of the slots that need to read a line
  std::uint64_t missing_ = 0;     ///< mask of the slots that wait for a line from memory
  std::uint64_t no_mshr_ = 0;     ///< mask of the slots that wait for an MSHR
  std::uint64_t resumed_ = 0;     ///< mask of the slots that stalled and may now probe again, before all others
  bool stalled_ = false;          ///< a slot stalls the fetch stage
  std::uint64_t table_full_ = 0;  ///< mask with the slot that stalls because the RAU table has no room for it
  Addr wanted_row_ = kAnyRow;     ///< line in whose row the stalled slot needs room; kAnyRow: it needs a free row
  std::uint32_t rows_used_ = 0;
  std::vector<std::uint64_t> filled_rau_rows_;  ///< for each RAU row whose line has arrived: mask of the slots that
                                                ///< have not resumed
};

}  // namespace hw
