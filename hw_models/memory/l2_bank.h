#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "hw_models/memory/cache.h"
#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/latency_sum.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/observer.h"
#include "hw_models/memory/unit_names.h"
#include "sim/link.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// The cached lines of one L2 bank, each with masks of its valid and its dirty sectors. A write allocates its line
/// without a fetch, so some sectors may be invalid. Dirty sectors are always valid.
class L2Store {
 public:
  enum class LookupResult : std::uint8_t { kNot, kPart, kAll };
  /// A line evicted from the L2. `sectors`: its dirty sectors, which must be written to memory.
  struct Victim {
    Addr line = 0;
    SectorMask sectors = 0;
  };

  explicit L2Store(const L2Config& config)
      : tags_(config.cache, config.banks), valid_(tags_.slot_count(), kWholeLine), dirty_(tags_.slot_count(), 0) {}

  /// Looks up a line in the L2 bank. Returns kNot if the line is not cached, kPart if some of the wanted sectors are
  /// invalid, kAll if all are valid.
  LookupResult look_up(Addr line, SectorMask wanted_sectors) {
    const std::size_t slot = tags_.look_up(line);
    if (slot == CacheTags::kNoSlot) return LookupResult::kNot;
    return (wanted_sectors & ~valid_[slot]) == 0 ? LookupResult::kAll : LookupResult::kPart;
  }

  /// Removes a line, which must be cached, from the L2 bank and returns the line's dirty sectors.
  SectorMask invalidate_line(Addr line) {
    const std::size_t slot = tags_.look_up(line);
    tags_.clear_slot(slot);
    return clean_slot(slot);
  }

  /// Writes sectors of a cached line and marks them dirty. Returns the written sectors that were already dirty.
  SectorMask write_sectors(Addr line, SectorMask sectors) {
    const std::size_t slot = tags_.look_up(line);
    const SectorMask before = dirty_[slot] & sectors;
    valid_[slot] |= sectors;
    mark_dirty(slot, sectors);
    return before;
  }

  /// Adds a line that is not cached, with the given valid and dirty sectors. Returns the evicted line.
  Victim allocate(Addr line, SectorMask valid_sectors, SectorMask dirty_sectors) {
    const CacheTags::FilledLine filled = tags_.fill_line(line);
    const Victim victim{filled.evicted, clean_slot(filled.slot)};
    valid_[filled.slot] = valid_sectors;
    mark_dirty(filled.slot, dirty_sectors);
    return victim;
  }

  /// Returns the number of lines in the L2 bank with at least one dirty sector.
  std::size_t dirty_lines() const { return dirty_lines_; }
  /// Marks the next dirty line, in slot order, as clean. Returns it with its sectors to write. Requires a dirty line.
  Victim clean_next_dirty_line() {
    while (dirty_[next_] == 0) next_ = next_ + 1 == dirty_.size() ? 0 : next_ + 1;
    return {tags_.line_at(next_), clean_slot(next_)};
  }

 private:
  void mark_dirty(std::size_t slot, SectorMask sectors) {
    dirty_lines_ += dirty_[slot] == 0 && sectors != 0;
    dirty_[slot] |= sectors;
  }
  SectorMask clean_slot(std::size_t slot) {
    const SectorMask sectors = dirty_[slot];
    dirty_lines_ -= sectors != 0;
    dirty_[slot] = 0;
    return sectors;
  }

  CacheTags tags_;
  std::vector<SectorMask> valid_, dirty_;  ///< masks of the valid and of the dirty sectors of each cache slot
  std::size_t dirty_lines_ = 0;
  std::size_t next_ = 0;  ///< slot at which the next search for a dirty line begins
};

/// One bank of the L2: accepts one request and returns one line per cycle.
///
///   cores_in --> arbiter --> [head] --> tags --hit--> [pipe: hit_cycles] ----------------> cores_out
///                              |                                        [waiters] --+-->
///                              +--miss--> [MSHRs] --> [to memory: lookup_cycles] --> channels_out
///                              +--write-> lines         channels_in --> fill, waiters of the line
///
/// 1. A read that misses needs a free MSHR, or a free target in the MSHR of its line. Otherwise it stays at the head of
/// the queue and blocks all later requests.
/// 2. A response has the `source` and `tag` of its request. In requests to memory, `source` is the bank's index.
/// 3. With L2Writes::kBack a write allocates a way without a fetch. A read of invalid sectors is a miss: the line
/// leaves its way, and its dirty sectors wait in the MSHR to be merged with the fill.
/// 4. The dirty sectors of an evicted line are written to memory. Memory takes as long for a masked write as for a
/// whole line.
/// 5. The Flush message at the end of a frame makes the bank write all dirty sectors to memory.
/// 6. The queue to memory has room for a request and a dirty victim of every MSHR, so a fill never waits for room
/// there.
/// 7. An ideal bank hits on every line. It accepts any number of requests per cycle, and answers each read a cycle
/// later.
///
/// Not modelled: contention of fills, writes and reads for the data array.
class L2Bank {
 public:
  static constexpr const char* kName = "l2.bank";
  static constexpr Block kBlock = Block::kL2;
  static constexpr std::size_t kMaxLinesPerTick = 1;  ///< maximum lines sent to one core per tick
  enum class CycleReason : std::uint8_t {
    kIdle,
    kServing,
    kLookup,
    kMemory,
    kMshrFull,
    kMemoryFull,
    kOutputFull,
    kCount
  };
  static constexpr auto kReasons = sim::reasons<CycleReason>({
      {CycleReason::kIdle, sim::idle_reason("idle", "nothing inside")},
      {CycleReason::kServing, sim::working_reason("serving", "a request or a line was accepted, or a line was sent")},
      {CycleReason::kLookup, sim::working_reason("lookup", "requests are inside the pipeline")},
      {CycleReason::kMemory, sim::waiting_reason("memory", "every request inside waits for DRAM")},
      {CycleReason::kMshrFull,
       sim::waiting_reason("mshr_full",
                           "the request at the head found no free MSHR, or no free target in its line's MSHR")},
      {CycleReason::kMemoryFull, sim::waiting_reason("memory_full", "a write waits for room at memory")},
      {CycleReason::kOutputFull, sim::waiting_reason("output_full", "a line waits for room towards its core")},
  });
  struct Stats {
    std::uint64_t reads = 0, hits = 0, misses = 0, merges = 0, fills = 0;
    std::uint64_t writes = 0, write_hits = 0, stored = 0, not_stored = 0, passed_on = 0, written_back = 0;
    std::uint64_t bytes_written = 0, bytes_overwritten = 0, bytes_to_memory = 0;
    std::uint64_t latency = 0, memory_cycles = 0, line_cycles = 0;
    static void describe(auto& s, auto&& counter) {
      counter(NAMED(s.reads), "requests looked up: hits + misses");
      counter(NAMED(s.hits), "requests that hit", "cache.l2_read");
      counter(NAMED(s.misses), "requests that missed", "cache.l2_probe");
      counter(NAMED(s.merges), "misses whose line was already in flight");
      counter(NAMED(s.fills), "lines filled from memory", "cache.l2_fill");
      counter(NAMED(s.writes), "writes of whole or partial lines: stored + not_stored");
      counter(NAMED(s.write_hits), "writes whose line was cached in whole or in part; with write-back also in flight");
      counter(NAMED(s.stored), "writes stored in the cache", "cache.l2_fill");
      counter(NAMED(s.not_stored), "writes that were not stored", "cache.l2_probe");
      counter(NAMED(s.passed_on), "writes passed on to memory");
      counter(NAMED(s.written_back), "whole or partial lines written to memory later", "cache.l2_read");
      counter(NAMED(s.bytes_written), "bytes of all writes");
      counter(NAMED(s.bytes_overwritten), "of these, bytes overwritten before they were written to memory");
      counter(NAMED(s.bytes_to_memory), "bytes written to memory");
      counter(NAMED(s.latency), "cycles from a read's arrival to its line's departure, summed over reads", "",
              sim::CounterKind::kAtEnd);
      counter(NAMED(s.memory_cycles), "of these, cycles in which misses waited for their lines", "",
              sim::CounterKind::kAtEnd);
      counter(NAMED(s.line_cycles), "sum over lines of cycles from the miss to the fill", "", sim::CounterKind::kAtEnd);
    }
  };
  struct Links {
    std::vector<sim::Link<MemRequest>*> cores_in;
    std::vector<sim::Link<MemResponse>*> cores_out;
    std::vector<sim::Link<MemRequest>*> channels_out;
    std::vector<sim::Link<MemResponse>*> channels_in;
    sim::Link<Flush>* flush_in = nullptr;  ///< link for Flush messages; null if the bank is never flushed
    Observer* observer = nullptr;
  };

  L2Bank(const L2Config& config, std::uint16_t index, Links links, Interleave channels, sim::Clock clock,
         Arbitration arbitration = Arbitration::kRoundRobin, bool ideal = false);
  L2Bank(const L2Bank&) = delete;
  L2Bank& operator=(const L2Bank&) = delete;

  sim::Time tick(sim::Time now);
  void finish(sim::Time end);
  /// True if the L2 bank holds no requests and, if it can be flushed, no dirty lines.
  bool idle() const;

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<CycleReason>& activity() const { return activity_; }
  std::string state() const;
  /// Puts a line into the L2 bank without taking simulated time. Dirty sectors of the evicted line are lost. Returns
  /// true if the line was already cached.
  bool warm_line(Addr line) {
    if (store_.look_up(line, 0) != L2Store::LookupResult::kNot) return true;
    store_.allocate(line, kWholeLine, 0);
    return false;
  }
  /// Removes a line from the L2 bank, if it is cached. Must be called before the first cycle.
  void drop_line(Addr line) {
    if (store_.look_up(line, 0) != L2Store::LookupResult::kNot) store_.invalidate_line(line);
  }
  const L2Store& store() const { return store_; }
  /// Replaces the lines in the L2 bank. Must be called before the first cycle.
  void set_store(const L2Store& store) { store_ = store; }

 private:
  struct Reply {
    MemResponse response;
    std::uint16_t core = 0;
    sim::Time arrived = 0;
  };
  struct Waiter {
    std::uint16_t core = 0, source = 0, tag = 0;
    sim::Time arrived = 0, missed = 0;  ///< times of the request's arrival at the bank and of its tag look-up
  };
  struct Waiters {
    std::uint32_t count = 0;
    SectorMask dirty = 0;    ///< dirty sectors of the missing line, to be merged with the fill
    TileTag tile = kNoTile;  ///< tile of the request that caused the miss
    std::array<Waiter, L2Config::kMaxTargets> list;
  };
  struct Head {
    MemRequest request;
    std::uint16_t core = 0;
    bool full = false;
    bool needs_mshr = false;  ///< the request missed and found no free MSHR
    sim::Time arrived = 0;
  };
  /// The line that was filled last into the L2 bank. The requests that waited for it are answered one per cycle.
  struct FilledLine {
    Addr line = 0;
    std::uint32_t next = 0,
                  count = 0;  ///< index of the next waiting request to answer, and number of all waiting requests
    const Waiters* waiters = nullptr;
    bool has_waiters() const { return next < count; }
    const Waiter& next_waiter() const { return waiters->list[next]; }
  };

  bool send_reply(sim::Time now);
  void take_fill(sim::Time now);
  void send_to_memory(sim::Time now);
  bool take_request(sim::Time now);
  bool process_read(sim::Time now);
  bool process_write(sim::Time now);
  void store_write(sim::Time now);
  bool flush_line(sim::Time now);
  void queue_to_memory(sim::Time now, const MemRequest& request);
  void write_back_victim(sim::Time now, const L2Store::Victim& victim, TileTag tile = kNoTile);
  /// True if the request at the head of the L2 bank's queue is blocked until a fill frees an MSHR.
  bool waits_for_fill() const { return head_.needs_mshr && misses_.is_full(); }
  /// True if the queue to memory has room for `request_count` requests and a dirty victim of every outstanding miss.
  bool has_room_to_memory(std::uint32_t request_count) const {
    return unsent_.size() + misses_.size() + request_count <= unsent_capacity_;
  }
  sim::Time tick_ideal(sim::Time now);
  CycleReason wait_reason(sim::Time now) const;
  sim::Time next_wake(sim::Time now) const;
  static constexpr std::uint16_t kNoCore = 0xffff;
  /// Returns the core of the next reply; kNoCore if the bank has no reply to send in this cycle.
  std::uint16_t reply_core(sim::Time now) const {
    if (filled_.has_waiters()) return filled_.next_waiter().core;
    return hits_.can_pop(now) ? hits_.front().core : kNoCore;
  }
  sim::Link<MemRequest>& channel_of(const MemRequest& request) const {
    return *channels_out_[channels_.index_of(request.line)];
  }

  const std::vector<sim::Link<MemResponse>*> cores_out_;
  const std::vector<sim::Link<MemRequest>*> channels_out_;
  const sim::Inputs<MemRequest> cores_in_;
  const sim::Inputs<MemResponse> channels_in_;
  sim::Link<Flush>* const flush_in_;
  Observer* const observer_;
  Interleave channels_;
  sim::Clock clock_;
  std::uint16_t index_;
  std::uint32_t targets_;
  L2Writes writes_;
  std::uint64_t sector_bytes_;
  L2Store store_;
  MshrFile<Waiters> misses_;
  sim::Link<Reply> hits_;
  std::uint32_t unsent_capacity_;
  sim::Link<MemRequest> unsent_;
  Head head_;
  FilledLine filled_;
  Arbiter cores_;
  Arbiter channels_turn_;
  bool flushing_ = false;
  /// One-cycle queues of replies to each core; empty unless the bank is ideal.
  std::deque<sim::Link<Reply>> ideal_;
  LatencySum read_time_;    ///< latencies of reads, from arrival to departure
  LatencySum memory_time_;  ///< latencies of misses, from look-up to fill
  LatencySum line_time_;    ///< times of outstanding lines, from first miss to fill
  Stats stats_;
  sim::Activity<CycleReason> activity_;
};

}  // namespace hw
