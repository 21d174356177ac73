#pragma once
#include <cstdint>
#include <string_view>

#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/l2_bank.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Configuration of the system-level cache (SLC), which has one slice in front of each DRAM channel. Size and number of
/// MSHRs are totals over all slices.
struct SystemCacheConfig {
  CacheConfig cache{.size = {0}, .ways = 16, .mshrs = 64, .hit_cycles = 16};
  std::uint32_t lookup_cycles = 8;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.cache.size, "size", "bytes", "capacity; 0: no system cache", sim::between(0, 64 << 20), Affects::kTiming);
    field(c.cache.ways, "ways", "ways", "lines of one set", sim::between(1, 64), Affects::kTiming);
    field(c.cache.replacement, "replacement", "", "replacement policy; plru needs a power of two of ways", sim::any(),
          Affects::kTiming);
    field(c.cache.mshrs, "mshrs", "registers", "misses in flight", sim::between(1, 1024), Affects::kTiming);
    field(c.cache.hit_cycles, "hit_cycles", "cycles",
          "latency of a hit, from probe to data, in cycles of the L2's clock", sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.lookup_cycles), "cycles", "from the arrival of a request until its miss is sent to memory",
          sim::between(1, 64), Affects::kTiming);
  }
  bool is_present() const { return cache.size.bytes != 0; }
  /// Returns the L2 configuration with which the slices of the system cache, which are L2 banks, are built.
  L2Config slice_config(std::uint32_t slices) const {
    return {.cache = cache, .banks = slices, .lookup_cycles = lookup_cycles, .writes = L2Writes::kBack};
  }
};

/// A slice of the system cache: an L2 bank between the L2 (and the DMA ports) and one DRAM channel.
///
///   L2 banks, DMA ports --> [slice k] --> channel k
///
/// 1. A written line stays in the slice until it is replaced. Nothing is written back at the end of a frame.
/// 2. The energy and area of the slice are part of block `l2`.
///
/// Not modelled: partitioning among the chip's clients, lines of clients other than the GPU.
class SystemCacheSlice : public L2Bank {
 public:
  static constexpr const char* kName = "slc.slice";
  using L2Bank::L2Bank;
};

}  // namespace hw
