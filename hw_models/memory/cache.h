#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#if defined(__SSE4_1__)
#include <smmintrin.h>
#endif

#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/messages.h"
#include "sim/branch_free.h"
#include "sim/hash.h"
#include "sim/link.h"
#include "sim/ring.h"

namespace hw {

/// The tag array of a set-associative cache, or of one bank of it.
///
///   line --> [ set: `ways` tags, `ways` times of last use, or a tree of bits ] --> slot of the line, or miss
///
/// 1. Lines are interleaved over the banks of a cache. Each bank has an equal share of the sets.
/// 2. A slot is one way of one set. A line keeps its slot until it is replaced.
class CacheTags {
 public:
  static constexpr std::size_t kNoSlot = std::numeric_limits<std::size_t>::max();
  /// Result of filling a cache line: its slot and, if `evicts`, the line that was evicted.
  struct FilledLine {
    std::size_t slot = 0;
    bool evicts = false;
    Addr evicted = 0;
  };

  /// `clock`: initial value of the counter that stamps each use of a line. Only tests set it, near the overflow.
  explicit CacheTags(const CacheConfig& config, std::uint32_t bank_count = 1, std::uint32_t clock = 0)
      : line_shift_(static_cast<std::uint32_t>(std::countr_zero(config.line.bytes))),
        set_shift_(line_shift_ + static_cast<std::uint32_t>(std::countr_zero(bank_count))),
        ways_(config.ways),
        stride_((config.ways + kLanes - 1) / kLanes * kLanes),
        words_(2 * stride_),
        replacement_(config.replacement),
        set_mask_(config.set_count() / bank_count - 1),
        sets_(config.set_count() / bank_count * 2 * stride_, 0),
        trees_(replacement_ == Replacement::kPlru ? config.set_count() / bank_count : 0, 0),
        clock_(clock) {
    assert(std::has_single_bit(bank_count) && config.set_count() >= bank_count);
    for (std::size_t set = 0; set < sets_.size(); set += 2 * stride_) std::fill_n(&sets_[set], stride_, kInvalid);
  }

  /// Returns the number of slots, including unused ones: the ways of a set are rounded up to a multiple of four.
  std::size_t slot_count() const { return sets_.size() / 2; }

  /// True if the cache holds the line. A hit marks the line as recently used.
  bool probe(Addr line) {
    const std::size_t set = set_of(line);
    std::uint32_t* const here = tags_of(set);
    const std::uint32_t way = find_way(here, tag_of(line));
    if (way == kNoWay) return false;
    mark_used(here, set, way);
    return true;
  }

  /// Returns the slot of the line and marks the line as recently used. Returns kNoSlot if the line is not cached.
  std::size_t look_up(Addr line) {
    const std::size_t set = set_of(line);
    const std::uint32_t way = find_way(set, tag_of(line));
    if (way == kNoWay) return kNoSlot;
    mark_used(set, way);
    return slot_of(set, way);
  }

  /// True if the cache holds the line. In contrast to probe(), the line is not marked as used.
  bool has_line(Addr line) const { return find_way(set_of(line), tag_of(line)) != kNoWay; }

  /// Prefetches the tags that a probe for the line reads into the host's cache. The simulated cache does not change.
  void prefetch_tags_on_host(Addr line) const { __builtin_prefetch(tags_of(set_of(line))); }

  /// Puts a line into an empty way of its set or, if there is none, in place of the victim of the replacement policy.
  FilledLine fill_line(Addr line) {
    const std::size_t set = set_of(line);
    const std::uint32_t found = find_way(set, tag_of(line));
    const std::uint32_t way = found != kNoWay ? found : choose_victim(set, tag_of(line));
    const std::uint32_t before = tags_of(set)[way];
    fills_ += 1;
    tags_of(set)[way] = tag_of(line);
    mark_used(set, way);
    return {slot_of(set, way), before != kInvalid && found == kNoWay, Addr{before} << line_shift_};
  }

  /// Removes the line of a slot from the cache.
  void clear_slot(std::size_t slot) {
    tags_of(slot / stride_)[slot % stride_] = kInvalid;
    use_times_of(slot / stride_)[slot % stride_] = 0;
  }
  /// Removes all lines from the cache. Returns their number.
  std::size_t clear() {
    std::size_t lines = 0;
    for (std::size_t slot = 0; slot < slot_count(); ++slot) {
      if (slot % stride_ >= ways_ || tags_of(slot / stride_)[slot % stride_] == kInvalid) continue;
      clear_slot(slot);
      lines += 1;
    }
    return lines;
  }
  /// Returns the address of the line in a slot, which must not be empty.
  Addr line_at(std::size_t slot) const { return Addr{tags_of(slot / stride_)[slot % stride_]} << line_shift_; }

 private:
  static constexpr std::uint32_t kInvalid = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kNoWay = std::numeric_limits<std::uint32_t>::max();
  static constexpr std::uint32_t kLanes = 4;

  /// Returns the number of the line in memory, which is used as its tag. Memory has fewer than 2^32 lines.
  std::uint32_t tag_of(Addr line) const { return static_cast<std::uint32_t>(line >> line_shift_); }
  std::size_t set_of(Addr line) const { return static_cast<std::size_t>((line >> set_shift_) & set_mask_); }
  std::size_t slot_of(std::size_t set, std::uint32_t way) const { return set * stride_ + way; }
  std::uint32_t* tags_of(std::size_t set) { return &sets_[set * words_]; }
  const std::uint32_t* tags_of(std::size_t set) const { return &sets_[set * words_]; }
  std::uint32_t* use_times_of(std::size_t set) { return tags_of(set) + stride_; }
  const std::uint32_t* use_times_of(std::size_t set) const { return tags_of(set) + stride_; }

  /// Returns the way of set `set` that holds the tag, or kNoWay.
  std::uint32_t find_way(std::size_t set, std::uint32_t tag) const { return find_way(tags_of(set), tag); }
  /// Returns the way of the set with the tags `set_tags` that holds the tag, or kNoWay.
  std::uint32_t find_way(const std::uint32_t* set_tags, std::uint32_t tag) const {
    if (const std::uint32_t mask = match_four_tags(set_tags, tag); mask != 0)
      return static_cast<std::uint32_t>(std::countr_zero(mask));
    for (std::uint32_t way = kLanes; way < stride_; way += kLanes) {
      const std::uint32_t mask = match_four_tags(set_tags + way, tag);
      if (mask != 0) return way + static_cast<std::uint32_t>(std::countr_zero(mask));
    }
    return kNoWay;
  }
  /// Compares four tags with `tag`. Returns a mask of the equal ones.
  static std::uint32_t match_four_tags(const std::uint32_t* four_tags, std::uint32_t tag) {
#if defined(__SSE4_1__)
    const __m128i all = _mm_loadu_si128(reinterpret_cast<const __m128i*>(four_tags));
    const __m128i same = _mm_cmpeq_epi32(all, _mm_set1_epi32(static_cast<std::int32_t>(tag)));
    return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(same)));
#else
    std::uint32_t mask = 0;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) mask |= std::uint32_t{four_tags[lane] == tag} << lane;
    return mask;
#endif
  }

  void mark_used(std::size_t set, std::uint32_t way) { mark_used(tags_of(set), set, way); }
  /// Marks a way of a set as recently used. `set_tags`: the tags of the set.
  void mark_used(std::uint32_t* set_tags, std::size_t set, std::uint32_t way) {
    if (clock_ == std::numeric_limits<std::uint32_t>::max()) [[unlikely]]
      renumber_use_times();
    set_tags[stride_ + way] = ++clock_;
    if (replacement_ == Replacement::kPlru) update_plru_tree(trees_[set], way);
  }
  /// Called before the clock of last uses overflows: replaces each time by its rank within its set, so that the clock
  /// can restart at a small value.
  void renumber_use_times();
  /// Returns an empty way of the set or, if there is none, the way whose line is to be replaced.
  std::uint32_t choose_victim(std::size_t set, std::uint32_t tag) const {
    const std::uint32_t least = sim::index_of_min(use_times_of(set), ways_);
    if (replacement_ == Replacement::kLru || tags_of(set)[least] == kInvalid) return least;
    if (replacement_ == Replacement::kRandom) return static_cast<std::uint32_t>(sim::hash(tag, fills_) % ways_);
    return plru_victim(trees_[set]);
  }

  // In the pseudo-LRU tree of a set, bit n selects which child of node n leads to the next victim. Node 1 is the root;
  // the children of node n are 2n and 2n + 1.
  void update_plru_tree(std::uint64_t& tree, std::uint32_t way) const {
    for (std::uint32_t node = way + ways_; node > 1; node /= 2) {
      const std::uint64_t bit = std::uint64_t{1} << (node / 2);
      tree = node % 2 == 0 ? tree | bit : tree & ~bit;
    }
  }
  std::uint32_t plru_victim(std::uint64_t tree) const {
    std::uint32_t node = 1;
    while (node < ways_) node = 2 * node + static_cast<std::uint32_t>((tree >> node) & 1U);
    return node - ways_;
  }

  std::uint32_t line_shift_;
  std::uint32_t set_shift_;
  std::uint32_t ways_, stride_;  ///< number of ways per set; that number rounded up to a multiple of four
  std::size_t words_;            ///< number of array elements per set in `sets_`
  Replacement replacement_;
  Addr set_mask_;
  std::vector<std::uint32_t> sets_;   ///< for each set, the tags of its ways, then the times of last use of its ways
  std::vector<std::uint64_t> trees_;  ///< tree of pseudo-LRU bits of each set
  std::uint32_t clock_;
  std::uint64_t fills_ = 0;
};

/// Miss status holding registers (MSHRs, Kroft 1981) of a cache: its outstanding lines, each with a payload. Lines are
/// stored contiguously, so a search can compare several at once. A payload does not move while its line is outstanding.
template <class Payload>
class MshrFile {
 public:
  explicit MshrFile(std::uint32_t capacity)
      : capacity_(capacity),
        lines_((capacity + sim::kMatchWidth - 1) / sim::kMatchWidth * sim::kMatchWidth, kNone),
        payloads_(capacity + 1),
        slots_(capacity + 1) {
    std::iota(slots_.begin(), slots_.end(), 0U);
  }

  std::uint32_t size() const { return size_; }
  std::uint32_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  bool is_full() const { return size_ == capacity_; }

  /// Returns the MSHR payload of an outstanding line, or nullptr if the line is not outstanding.
  Payload* find_payload(Addr line) {
    const std::uint32_t i = index_of(line);
    return i == size_ ? nullptr : &payloads_[slots_[i]];
  }

  /// Allocates an MSHR for a line that is not outstanding. Returns its payload, which is not reset.
  Payload& allocate(Addr line) {
    assert(!is_full() && find_payload(line) == nullptr);
    lines_[size_] = line;
    return payloads_[slots_[size_++]];
  }

  /// Frees the MSHR of a line. Returns its payload, which stays valid until the next release.
  const Payload& release(Addr line) {
    const std::uint32_t i = index_of(line);
    assert(i < size_ && "a line came back without a request");
    const std::uint32_t freed = slots_[i];
    size_ -= 1;
    lines_[i] = lines_[size_];
    lines_[size_] = kNone;
    slots_[i] = slots_[size_];
    slots_[size_] = slots_.back();
    slots_.back() = freed;
    return payloads_[freed];
  }

 private:
  std::uint32_t index_of(Addr line) const {
    for (std::uint32_t first = 0; first < size_; first += sim::kMatchWidth) {
      const unsigned here = sim::match_mask8(&lines_[first], line);
      if (here != 0) return first + static_cast<std::uint32_t>(std::countr_zero(here));
    }
    return size_;
  }

  static constexpr Addr kNone = ~Addr{0};  ///< marks unused entries of `lines_`; no line has this address

  std::uint32_t capacity_;
  std::uint32_t size_ = 0;
  std::vector<Addr> lines_;  ///< addresses of the outstanding lines, followed by kNone in unused entries
  std::vector<Payload> payloads_;
  /// Index in `payloads_` of each line in `lines_`. The last entry is the payload that was released last.
  std::vector<std::uint32_t> slots_;
};

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
    bool only_prefetched = false;    ///< the line was prefetched, and no slot has needed it yet
  };

  /// What became of prefetched lines, counted after count_prefetches().
  struct PrefetchCounts {
    std::uint64_t useful = 0;   ///< prefetched lines that were read after they arrived
    std::uint64_t late = 0;     ///< prefetched lines that were needed before they arrived
    std::uint64_t useless = 0;  ///< prefetched lines that were evicted unread
  };

  L1Cache(const CacheConfig& config, std::uint16_t source, bool ideal = false)
      : tags_(config), misses_(config.mshrs), source_(source), ideal_(ideal) {}

  Result access_line(Addr line, std::uint32_t slot, std::uint64_t cycle = 0) {
    if (!prefetched_.empty()) note_use(line);
    if (ideal_ || tags_.probe(line)) return Result::kHit;
    const std::uint64_t bit = std::uint64_t{1} << slot;
    if (Miss* miss = misses_.find_payload(line)) {
      prefetch_counts_.late += miss->only_prefetched;
      miss->only_prefetched = false;
      miss->slots |= bit;
      return Result::kMiss;
    }
    if (misses_.is_full()) return Result::kFull;
    request_line(line, {bit, cycle}, slot_tiles_[slot]);
    return Result::kMiss;
  }

  /// Reads a line if it is cached. Otherwise returns false without side effects. Must not be called for ideal caches.
  bool try_hit(Addr line) { return tags_.probe(line); }

  /// Prefetches a line into the first-level cache, on behalf of a tile. No slot waits for the line. Returns false if
  /// the line is cached or already requested. Requires a free MSHR.
  bool prefetch_line(Addr line, TileTag tile, std::uint64_t cycle) {
    if (has_line(line) || find_miss(line) != nullptr) return false;
    request_line(line, {0, cycle, true}, tile);
    return true;
  }
  /// Result of a read for the owning unit itself.
  struct UnitRead {
    bool is_hit = false;
    bool is_request = false;  ///< the line has been requested from memory, by this read
  };
  /// Reads a line for the owning unit itself, not for one of its slots. Without a hit, fill_line() brings the line.
  /// Requires a free MSHR.
  UnitRead read_for_unit(Addr line, TileTag tile, std::uint64_t cycle) {
    if (ideal_ || tags_.probe(line)) return {.is_hit = true};
    if (find_miss(line) != nullptr) return {};
    request_line(line, {0, cycle}, tile);
    return {.is_request = true};
  }
  /// Makes the first-level cache count what becomes of prefetched lines, by a bit for each of its lines. The unit must
  /// then read all lines through access_line().
  void count_prefetches() { prefetched_.assign(tags_.slot_count(), 0); }
  const PrefetchCounts& prefetch_counts() const { return prefetch_counts_; }

  /// Attributes later memory requests of a slot to the given tile.
  void set_slot_tile(std::uint32_t slot, TileTag tile) { slot_tiles_[slot] = tile; }
  TileTag slot_tile(std::uint32_t slot) const { return slot_tiles_[slot]; }

  /// Fills a line into the first-level cache and frees its MSHR. Returns the completed miss: the slots that waited for
  /// the line, and the cycle of the miss.
  Miss fill_line(Addr line) {
    const CacheTags::FilledLine filled = tags_.fill_line(line);
    const Miss miss = misses_.release(line);
    if (!prefetched_.empty()) [[unlikely]] {
      prefetch_counts_.useless += prefetched_[filled.slot];
      prefetched_[filled.slot] = miss.only_prefetched;
    }
    return miss;
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
  void set_tags(const CacheTags& tags) {
    tags_ = tags;
    std::ranges::fill(prefetched_, 0);
  }

  /// Removes all lines from the first-level cache and returns their number. Outstanding misses continue.
  std::size_t clear() { return tags_.clear(); }

  /// True if the line is cached. The line is not marked as used.
  bool has_line(Addr line) const { return ideal_ || tags_.has_line(line); }
  /// Prefetches the tags that a probe for the line reads into the host's cache. The simulated cache does not change.
  void prefetch_tags_on_host(Addr line) const { tags_.prefetch_tags_on_host(line); }
  /// Returns the outstanding miss of a cache line, or null if the line is not requested.
  const Miss* find_miss(Addr line) { return misses_.find_payload(line); }

  /// Adds slots to those that wait for an outstanding line.
  void add_waiting_slots(Addr line, std::uint64_t slot_mask) { misses_.find_payload(line)->slots |= slot_mask; }

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
  /// Counts the first use of a cached line that was prefetched.
  void note_use(Addr line) {
    const std::size_t slot = tags_.look_up(line);
    if (slot == CacheTags::kNoSlot) return;
    prefetch_counts_.useful += prefetched_[slot];
    prefetched_[slot] = 0;
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
  std::vector<std::uint8_t> prefetched_;  ///< for each slot of the tags, 1 if its line was prefetched and not used yet;
                                          ///< empty: prefetches are not counted
  PrefetchCounts prefetch_counts_;
};

}  // namespace hw
