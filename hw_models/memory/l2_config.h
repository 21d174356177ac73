#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/interleave.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Write policy of the L2.
enum class L2Writes : std::uint8_t {
  kBack,     ///< keeps it; memory gets it when the line is replaced
  kThrough,  ///< passes it on to memory, and brings the line up to date if it is here
  kAround,   ///< passes it on to memory, and forgets the line if it is here
};
constexpr std::array<std::string_view, 3> names_of(L2Writes) { return {"back", "through", "around"}; }

/// The second-level cache, shared by all cores. Size and MSHRs are those of all banks together.
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
    field(NAMED(c.lookup_cycles), "cycles", "from a request's arrival until its miss leaves", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.targets), "requests", "requests that may wait for one line on its way", sim::between(1, kMaxTargets),
          Affects::kTiming);
    field(NAMED(c.writes), "",
          "what becomes of writes: kept until the line is replaced, passed on, or passed on and the line forgotten",
          sim::any(), Affects::kTiming);
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

}  // namespace hw
