#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "hw_models/memory/messages.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Replacement policy of a cache: which line of a full set a fill evicts.
enum class Replacement : std::uint8_t {
  kLru,     ///< LRU: the least recently used line is evicted
  kPlru,    ///< pseudo-LRU: a tree of bits, each pointing away from the half used last, selects the line
  kRandom,  ///< a pseudo-random line, chosen by a hash, is evicted
};
constexpr std::array<std::string_view, 3> names_of(Replacement) { return {"lru", "plru", "random"}; }

/// Size and organisation of a cache: size = sets x ways x line.
struct CacheConfig {
  sim::ByteSize size{16 * 1024};
  sim::ByteSize line{kLineBytes};
  std::uint32_t ways = 4;
  std::uint32_t mshrs = 8;
  sim::AutoCount hit_cycles = 2;
  Replacement replacement = Replacement::kLru;

  static void describe(auto& c, auto&& field) {
    describe_shape(c, field);
    field(NAMED(c.hit_cycles), "cycles", "latency of a hit, from probe to data; auto: from size and latency.*",
          sim::between(1, 64), sim::Affects::kTiming);
  }
  /// Declares all configuration fields except hit_cycles, for caches whose hit latency is configured elsewhere.
  static void describe_shape(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.size), "bytes", "capacity: sets x ways x line", sim::between(64, 16 << 20), Affects::kTiming);
    field(NAMED(c.line), "bytes", "bytes of one line", sim::power_of_two(16, 256), Affects::kTiming);
    field(NAMED(c.ways), "ways", "lines of one set", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.replacement), "", "replacement policy; plru needs a power of two of ways", sim::any(),
          Affects::kTiming);
    field(NAMED(c.mshrs), "registers", "miss status holding registers: lines in flight", sim::between(1, 256),
          Affects::kTiming);
  }

  void check(auto&& complain) const {
    const std::string shape = std::to_string(ways) + " ways of " + std::to_string(line.bytes) + " bytes";
    if (!std::has_single_bit(line.bytes)) {
      complain("line", "a cache line must be a power of two bytes, not " + std::to_string(line.bytes));
    } else if (ways == 0 || size.bytes == 0 || size.bytes % (ways * line.bytes) != 0) {
      complain("size", std::to_string(size.bytes) + " bytes cannot be divided into sets of " + shape);
    } else if (!std::has_single_bit(set_count())) {
      complain("size", std::to_string(size.bytes) + " bytes in sets of " + shape + " make " +
                           std::to_string(set_count()) + " sets; the number of sets must be a power of two");
    } else if (replacement == Replacement::kPlru && !std::has_single_bit(ways)) {
      complain("replacement", "plru halves a set again and again: " + std::to_string(ways) +
                                  " ways are no power of two; allowed: lru, random");
    }
  }

  std::uint64_t set_count() const { return size.bytes / (ways * line.bytes); }
};

/// Write policy of the L2 cache.
enum class L2Writes : std::uint8_t {
  kBack,     ///< write-back: the L2 stores the write; memory is written when the line is evicted
  kThrough,  ///< write-through: the L2 forwards the write to memory and updates the line if it is cached
  kAround,   ///< write-around: the L2 forwards the write to memory and invalidates the line if it is cached
};
constexpr std::array<std::string_view, 3> names_of(L2Writes) { return {"back", "through", "around"}; }

/// Configuration of the second-level cache (L2), which all cores share. Size and MSHRs are totals over all banks.
struct L2Config {
  CacheConfig cache{.size = {256 * 1024}, .ways = 8, .mshrs = 32, .hit_cycles = 12};
  std::uint32_t banks = 4;
  std::uint32_t lookup_cycles = 4;
  std::uint32_t targets = 16;
  L2Writes writes = L2Writes::kBack;

  static constexpr std::uint32_t kMaxTargets = 16;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    CacheConfig::describe(c.cache, field);
    field(NAMED(c.banks), "banks", "banks, interleaved by line", sim::power_of_two(1, 64), Affects::kTiming);
    field(NAMED(c.lookup_cycles), "cycles", "from the arrival of a request until its miss is sent to memory",
          sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.targets), "requests", "requests that may wait for one line in flight", sim::between(1, kMaxTargets),
          Affects::kTiming);
    field(NAMED(c.writes), "", "write policy: write-back, write-through, or write-around (the line is invalidated)",
          sim::any(), Affects::kTiming);
  }
  void check(auto&& complain) const {
    cache.check(complain);
    if (!std::has_single_bit(banks) || cache.mshrs % banks != 0)
      complain("mshrs", std::to_string(cache.mshrs) + " miss registers cannot be divided over " +
                            std::to_string(banks) + " banks");
    if (cache.set_count() % banks != 0)
      complain("banks",
               "more banks (" + std::to_string(banks) + ") than sets (" + std::to_string(cache.set_count()) + ")");
  }
  std::uint32_t mshrs_per_bank() const { return cache.mshrs / banks; }
  Interleave bank_interleave() const { return {cache.line.bytes, banks}; }
};

}  // namespace hw
