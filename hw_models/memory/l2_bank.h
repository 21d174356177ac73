#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hw_models/memory/cache_tags.h"
#include "hw_models/memory/interleave.h"
#include "hw_models/memory/messages.h"
#include "hw_models/memory/mshr_file.h"
#include "sim/activity.h"
#include "sim/link.h"

namespace hw {

/// The second-level cache, shared by all cores. Size and miss registers are those of all banks together.
struct L2Config {
  CacheConfig cache{.size = {256 * 1024}, .line = {64}, .ways = 8, .mshrs = 32, .hit_cycles = 12};
  std::uint32_t banks = 4;
  std::uint32_t lookup_cycles = 4;
  std::uint32_t targets = 16;

  static constexpr std::uint32_t kMaxTargets = 16;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    CacheConfig::describe(c.cache, field);
    field(c.banks, "banks", "banks", "banks, interleaved by line", sim::power_of_two(1, 64), Affects::kTiming);
    field(c.lookup_cycles, "lookup_cycles", "cycles", "from a request's arrival until its miss leaves",
          sim::between(1, 64), Affects::kTiming);
    field(c.targets, "targets", "requests", "requests that may wait for one line on its way",
          sim::between(1, kMaxTargets), Affects::kTiming);
  }
  void check(auto&& complain) const {
    cache.check(complain);
    if (!std::has_single_bit(banks) || cache.mshrs % banks != 0)
      complain("mshrs", std::to_string(cache.mshrs) + " miss registers cannot be divided over " +
                            std::to_string(banks) + " banks");
    if (cache.sets() % banks != 0)
      complain("banks", "more banks (" + std::to_string(banks) + ") than sets (" + std::to_string(cache.sets()) + ")");
  }
  std::uint32_t mshrs_per_bank() const { return cache.mshrs / banks; }
  Interleave interleave() const { return {cache.line.bytes, banks}; }
};

/// One bank of the L2: takes one request per cycle, gives one line per cycle.
///
///   cores_in --> round robin --> [head] --> tags --hit--> [pipe: hit_cycles] ----------------> cores_out
///                                  |                                        [waiters] --+-->
///                                  +--miss--> [MSHRs] --> [lookup_cycles] --> channels_out
///                                                         channels_in --> fill, waiters of the line
///
/// A request that finds neither its line nor a free miss register (or no free place among the line's targets) stays
/// in the head and holds up all behind it. `source` and `tag` are returned unchanged to the core the request came from;
/// towards memory, `source` is the bank's index.
/// Not modelled: writes (frame buffer and spills go around the L2 by DMA, so that every victim is clean), and
/// contention of fills and reads for the data array.
class L2Bank {
 public:
  enum class Why : std::uint8_t {
    kIdle,        ///< nothing inside
    kServing,     ///< a request or a line came in, or a line went out
    kLookup,      ///< requests are inside the pipeline
    kMemory,      ///< every request inside waits for DRAM
    kMshrFull,    ///< the head found no miss register, or no place among its line's targets
    kOutputFull,  ///< a line cannot leave towards its core
    kCount
  };
  struct Stats {
    std::uint64_t reads = 0, hits = 0, misses = 0, merges = 0, fills = 0;
    static void describe(auto& s, auto&& counter) {
      counter(s.reads, "reads", "requests looked up: hits + misses");
      counter(s.hits, "hits", "requests that found their line", "cache.l2_read");
      counter(s.misses, "misses", "requests that did not", "cache.l2_probe");
      counter(s.merges, "merges", "misses whose line was already on its way");
      counter(s.fills, "fills", "lines filled from memory", "cache.l2_fill");
    }
  };
  struct Links {
    std::vector<sim::Link<MemRequest>*> cores_in;
    std::vector<sim::Link<MemResponse>*> cores_out;
    std::vector<sim::Link<MemRequest>*> channels_out;
    std::vector<sim::Link<MemResponse>*> channels_in;
  };

  L2Bank(const L2Config& config, std::uint16_t index, Links links, Interleave channels, sim::Clock clock);
  L2Bank(const L2Bank&) = delete;
  L2Bank& operator=(const L2Bank&) = delete;

  sim::Time tick(sim::Time now);
  void finish(sim::Time end) { activity_.finish(end); }
  /// Forgets every line (the start of a frame). Only while nothing is inside.
  void invalidate() { tags_.invalidate(); }

  const sim::Clock& clock() const { return clock_; }
  const Stats& stats() const { return stats_; }
  const sim::Activity<Why>& activity() const { return activity_; }
  std::string state() const;

 private:
  struct Reply {
    MemResponse response;
    std::uint16_t core = 0;
  };
  struct Waiter {
    std::uint16_t core = 0, source = 0, tag = 0;
  };
  struct Waiters {
    std::uint32_t count = 0;
    std::array<Waiter, L2Config::kMaxTargets> list;
  };
  struct Head {
    MemRequest request;
    std::uint16_t core = 0;
    bool full = false;
  };
  /// The line being handed to those who waited for it.
  struct Filled {
    Addr line = 0;
    std::uint32_t next = 0;
    Waiters waiters;
    bool pending() const { return next < waiters.count; }
  };

  bool reply(sim::Time now);
  bool take_fill(sim::Time now);
  bool take_request(sim::Time now);
  bool look_up(sim::Time now);
  void send_miss(sim::Time now);
  Why waiting(sim::Time now) const;
  sim::Time next_wake(sim::Time now) const;
  std::optional<Reply> next_reply(sim::Time now) const;
  sim::Link<MemRequest>& channel_of(const MemRequest& request) const {
    return *links_.channels_out[channels_.owner(request.line)];
  }

  Links links_;
  Interleave channels_;
  sim::Clock clock_;
  std::uint16_t index_;
  std::uint32_t targets_;
  CacheTags tags_;
  MshrFile<Waiters> misses_;
  sim::Link<Reply> hits_;
  sim::Link<MemRequest> unsent_;
  Head head_;
  Filled filled_;
  std::uint32_t core_turn_ = 0;
  std::uint32_t channel_turn_ = 0;
  Stats stats_;
  sim::Activity<Why> activity_;
};

constexpr std::array<std::string_view, 6> names_of(L2Bank::Why) {
  return {"idle", "serving", "lookup", "memory", "mshr_full", "output_full"};
}

}  // namespace hw
