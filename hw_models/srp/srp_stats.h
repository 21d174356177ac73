#pragma once
#include <cstdint>
#include <utility>

#include "hw_models/srp/schedule.h"
#include "sim/named.h"

namespace hw {

/// Counters of the use of a shader core by one kernel.
struct KernelUse {
  std::uint64_t launches = 0;  ///< number of array loops of the kernel, each with prologue and drain
  std::uint64_t items = 0;
  std::uint64_t idle = 0;     ///< number of idle items, which are included in `items`
  std::uint64_t cycles = 0;   ///< shader core cycles of the kernel, including switches and stalls
  std::uint64_t starved = 0;  ///< number of the kernel's cycles in which the T&I unit had no ray

  /// The counts of a kernel's use, by name.
  static constexpr std::pair<const char*, std::uint64_t KernelUse::*> kCounts[] = {{"launches", &KernelUse::launches},
                                                                                   {"items", &KernelUse::items},
                                                                                   {"idle", &KernelUse::idle},
                                                                                   {"cycles", &KernelUse::cycles},
                                                                                   {"starved", &KernelUse::starved}};

  KernelUse& operator+=(const KernelUse& other) {
    for (const auto& [name, count] : kCounts) this->*count += other.*count;
    return *this;
  }
  KernelUse& operator-=(const KernelUse& other) {
    for (const auto& [name, count] : kCounts) this->*count -= other.*count;
    return *this;
  }
};

/// Counters of a shader core.
struct SrpStats {
  std::uint64_t tiles = 0, chunks = 0, launches = 0, merged = 0, items = 0, rays = 0, hits = 0;
  std::uint64_t switches = 0, resident_switches = 0, cold_switches = 0;
  std::uint64_t config_rows_switched = 0, config_rows_loaded = 0;
  std::uint64_t fp_add = 0, fp_mul = 0, fp_mul_add = 0, fp_div_sqrt = 0, fp_compare = 0;
  std::uint64_t int_add = 0, int_mul = 0, int_logic = 0, int_shift = 0, convert = 0;
  std::uint64_t rf_reads = 0, rf_writes = 0, route_hops = 0, config_reads = 0;
  std::uint64_t fed = 0, awaited = 0;
  std::uint64_t cache_accesses = 0, cache_hits = 0, cache_misses = 0, cache_fills = 0, cache_miss_cycles = 0,
                mshr_full = 0, queued_loads = 0;

  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.tiles), "tiles taken");
    counter(NAMED(s.chunks), "loops run on the array: a chunk of a launch, or several merged");
    counter(NAMED(s.launches), "chunks of launches in these loops");
    counter(NAMED(s.merged), "loops of more than one chunk");
    counter(NAMED(s.items), "work items run on the array, idle ones included");
    counter(NAMED(s.switches), "kernel switches");
    counter(NAMED(s.resident_switches), "of these, to kernels in configuration memory");
    counter(NAMED(s.cold_switches), "of these, to kernels that were loaded first");
    counter(NAMED(s.config_rows_switched), "configuration rows moved to the array by switches", "srp.config_switch");
    counter(NAMED(s.config_rows_loaded), "configuration rows loaded by cold switches", "srp.config_load");
    counter(NAMED(s.rays), "rays sent to the T&I unit", "tni.ray_route");
    counter(NAMED(s.hits), "hits received from the T&I unit", "tni.hit_route");
    counter(NAMED(s.fed), "cycles with rays in the T&I unit");
    counter(NAMED(s.awaited), "of these, cycles with nothing on the array");
    counter(NAMED(s.fp_add), "additions and subtractions", energy_event_of(OpClass::kFpAdd));
    counter(NAMED(s.fp_mul), "multiplications", energy_event_of(OpClass::kFpMul));
    counter(NAMED(s.fp_mul_add), "fused multiply-adds", energy_event_of(OpClass::kFpMulAdd));
    counter(NAMED(s.fp_div_sqrt), "divisions and square roots", energy_event_of(OpClass::kFpDivSqrt));
    counter(NAMED(s.fp_compare), "comparisons, minima and maxima", energy_event_of(OpClass::kFpCompare));
    counter(NAMED(s.int_add), "integer additions and comparisons", energy_event_of(OpClass::kIntAdd));
    counter(NAMED(s.int_mul), "integer multiplications", energy_event_of(OpClass::kIntMul));
    counter(NAMED(s.int_logic), "logic operations and selects", energy_event_of(OpClass::kIntLogic));
    counter(NAMED(s.int_shift), "shifts", energy_event_of(OpClass::kIntShift));
    counter(NAMED(s.convert), "conversions", energy_event_of(OpClass::kConvert));
    counter(NAMED(s.rf_reads), "register operands read", "srp.rf_read");
    counter(NAMED(s.rf_writes), "register results written", "srp.rf_write");
    counter(NAMED(s.route_hops), "operands routed between units", "srp.route_hop");
    counter(NAMED(s.config_reads), "configuration words read, one per unit and cycle", "srp.config_read");
    counter(NAMED(s.cache_accesses), "probes of the data cache, retries included");
    counter(NAMED(s.cache_hits), "of these, lines found", "cache.l1_read");
    counter(NAMED(s.cache_misses), "of these, lines not found", "cache.l1_probe");
    counter(NAMED(s.cache_fills), "lines filled", "cache.l1_fill");
    counter(NAMED(s.cache_miss_cycles), "sum over lines of cycles from the miss to the line's arrival");
    counter(NAMED(s.mshr_full), "misses that found no free MSHR");
    counter(NAMED(s.queued_loads), "loads that went through the load queue", "srp.load_queue");
  }

  /// Counts a switch to a kernel with `config_rows` configuration rows. `is_resident`: configuration memory has them.
  void add_switch(std::uint32_t config_rows, bool is_resident) {
    switches += 1;
    resident_switches += is_resident ? 1 : 0;
    cold_switches += is_resident ? 0 : 1;
    config_rows_switched += config_rows;
    config_rows_loaded += is_resident ? 0 : config_rows;
  }

  /// Counts the events of a loop of `item_count` items of a kernel. Items from `non_idle_count` on are idle.
  void add_loop(const KernelSchedule& kernel, std::uint64_t item_count, std::uint64_t non_idle_count) {
    const auto ops = [&](OpClass c) { return item_count * kernel.ops[static_cast<std::size_t>(c)]; };
    chunks += 1;
    items += item_count;
    fp_add += ops(OpClass::kFpAdd);
    fp_mul += ops(OpClass::kFpMul);
    fp_mul_add += ops(OpClass::kFpMulAdd);
    fp_div_sqrt += ops(OpClass::kFpDivSqrt);
    fp_compare += ops(OpClass::kFpCompare);
    int_add += ops(OpClass::kIntAdd);
    int_mul += ops(OpClass::kIntMul);
    int_logic += ops(OpClass::kIntLogic);
    int_shift += ops(OpClass::kIntShift);
    convert += ops(OpClass::kConvert);
    rf_reads += item_count * kernel.rf_reads;
    rf_writes += item_count * kernel.rf_writes;
    route_hops += item_count * kernel.route_hops;
    queued_loads += non_idle_count * kernel.queued_loads;
    config_reads += (kernel.depth + (item_count - 1) * kernel.ii) *
                    (kernel.config_reads / kernel.ii);  // also during prologue and drain
  }
};

}  // namespace hw
