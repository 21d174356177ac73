#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "hw_models/memory/cache_config.h"
#include "sim/config/field.h"
#include "sim/named.h"
#include "sim/unit_report.h"

namespace hw {

/// Configuration of the shader core's array of functional units (FUs). All FUs add, compare, shift and convert. The
/// first `mul_units` also multiply, and the first `div_sqrt_units` also divide and take square roots.
struct ArrayConfig {
  std::uint32_t rows = 4;
  std::uint32_t columns = 4;
  std::uint32_t mul_units = 16;
  bool mul_add = false;
  std::uint32_t div_sqrt_units = 4;
  std::uint32_t local_ports = 4;
  std::uint32_t cache_ports = 1;
  sim::ByteSize cache_port_width{64};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.rows), "units", "rows of functional units", sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.columns), "units", "functional units of a row", sim::between(1, 16), Affects::kTiming);
    field(NAMED(c.mul_units), "units", "functional units with a multiplier", sim::between(1, 256), Affects::kTiming);
    field(NAMED(c.mul_add), "",
          "multipliers can add to or subtract from the product in the same operation, with both roundings", sim::any(),
          Affects::kTiming);
    field(NAMED(c.div_sqrt_units), "units", "functional units with a divider and square root", sim::between(1, 256),
          Affects::kTiming);
    field(NAMED(c.local_ports), "ports", "16-byte loads or stores of local memory per cycle", sim::between(1, 16),
          Affects::kTiming);
    field(NAMED(c.cache_ports), "ports", "loads through the data cache per cycle", sim::between(1, 16),
          Affects::kTiming);
    field(NAMED(c.cache_port_width), "bytes", "bytes of a record that one such load reads", sim::power_of_two(16, 64),
          Affects::kTiming);
  }
  void check(auto&& complain) const {
    const std::string all = " of " + std::to_string(unit_count()) + " functional units";
    if (mul_units > unit_count()) complain("mul_units", std::to_string(mul_units) + all + " cannot have a multiplier");
    if (div_sqrt_units > unit_count()) {
      complain("div_sqrt_units", std::to_string(div_sqrt_units) + all + " cannot have a divider");
    }
  }

  std::uint32_t unit_count() const { return rows * columns; }
  /// Returns the parts of the array for the area model. A multiplier handles floats and integers; a multiply-add unit
  /// also contains an adder.
  std::vector<sim::UnitPart> parts() const {
    return {{"functional_unit", unit_count()},
            {"multiplier", mul_units},
            {"product_adder", mul_add ? mul_units : 0},
            {"div_sqrt", div_sqrt_units}};
  }
};

/// Maximum latency of a data-cache load in cycles. It is 64 because a 64-bit word has one bit for each loop item that
/// waits for lines.
inline constexpr std::uint32_t kMostLoadCycles = 64;

/// Latencies of kernel operations: cycles from an operation's issue to the first use of its result.
struct OpLatencyConfig {
  std::uint32_t fp_add = 2;
  std::uint32_t fp_mul = 2;
  std::uint32_t fp_compare = 1;
  std::uint32_t div_sqrt = 16;
  std::uint32_t div_sqrt_interval = 1;  // pipelined, as in SimTRaX, the source of latency, area and energy
  std::uint32_t integer = 1;
  std::uint32_t int_mul = 2;
  std::uint32_t convert = 1;
  std::uint32_t local_load = 6;
  std::uint32_t cached_load = 4;
  std::uint32_t load_queue = 60;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    const auto cycles = sim::between(1, 64);
    field(NAMED(c.fp_add), "cycles", "floating-point addition and subtraction", cycles, Affects::kTiming);
    field(NAMED(c.fp_mul), "cycles", "floating-point multiplication", cycles, Affects::kTiming);
    field(NAMED(c.fp_compare), "cycles", "floating-point comparison, minimum, maximum", cycles, Affects::kTiming);
    field(NAMED(c.div_sqrt), "cycles", "division and square root", cycles, Affects::kTiming);
    field(NAMED(c.div_sqrt_interval), "cycles",
          "cycles that a division or square root occupies its functional unit (1: pipelined)", cycles,
          Affects::kTiming);
    field(NAMED(c.integer), "cycles", "integer addition and comparison, logic, shift, select", cycles,
          Affects::kTiming);
    field(NAMED(c.int_mul), "cycles", "integer multiplication", cycles, Affects::kTiming);
    field(NAMED(c.convert), "cycles", "between float and integer, floor", cycles, Affects::kTiming);
    field(NAMED(c.local_load), "cycles", "load from tile buffer or kernel data", cycles, Affects::kTiming);
    field(NAMED(c.cached_load), "cycles", "load that hits the data cache, without load_queue", cycles,
          Affects::kTiming);
    field(NAMED(c.load_queue), "cycles",
          "queueing time of every data-cache load; a miss that is filled within this time stalls nothing",
          sim::between(0, kMostLoadCycles - 1), Affects::kTiming);
  }
  void check(auto&& complain) const {
    if (cached_load_latency() <= kMostLoadCycles) return;
    complain("load_queue", std::to_string(load_queue) + " and cached_load, " + std::to_string(cached_load) +
                               ", make more than " + std::to_string(kMostLoadCycles) + " cycles");
  }

  /// Returns the cycles from the issue of a data-cache load to the first use of its data, if it hits.
  std::uint32_t cached_load_latency() const { return cached_load + load_queue; }
};

/// Configuration of the shader core's data cache. Its hit latency is latency.cached_load + latency.load_queue.
struct DataCacheConfig : CacheConfig {
  static void describe(auto& c, auto&& field) { describe_shape(c, field); }
};

/// Configuration of the shader core (SRP): an array of functional units that runs kernels as software-pipelined loops.
struct SrpConfig {
  ArrayConfig array;
  OpLatencyConfig latency;
  std::uint32_t switch_cycles = 8;
  std::uint32_t chunk = 256;
  bool merge = false;
  DataCacheConfig data_cache{{.mshrs = 32}};
  sim::ByteSize kernel_data{64 * 1024};
  sim::ByteSize config_memory{36 * 1024};
  sim::ByteSize config_word{8};
  sim::ByteSize config_load{64};

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field.group(NAMED(c.array), "functional units and memory ports");
    field.group(NAMED(c.latency), "latencies of operations and loads");
    field(NAMED(c.switch_cycles), "cycles",
          "cycles to switch to a kernel in configuration memory; other kernels are loaded first",
          sim::between(0, 100'000), Affects::kTiming);
    field(NAMED(c.chunk), "items", "items of a launch that run as one loop", sim::between(1, 65536), Affects::kTiming);
    field(NAMED(c.merge), "", "ready chunks of one kernel run as one loop of up to `chunk` items", sim::any(),
          Affects::kTiming);
    field.group(NAMED(c.data_cache), "attributes, materials and textures");
    field(NAMED(c.kernel_data), "bytes",
          "local memory for kernel data in addition to the tile buffer, for leakage and area",
          sim::between(0, 16 << 20), Affects::kEnergy);
    field(NAMED(c.config_memory), "bytes", "configuration memory of the array, which holds as many kernels as fit",
          sim::between(0, 16 << 20), Affects::kTiming);
    field(NAMED(c.config_word), "bytes",
          "configuration of one functional unit for one cycle of a kernel's initiation interval", sim::between(1, 256),
          Affects::kTiming);
    field(NAMED(c.config_load), "bytes", "configuration bytes loaded from memory per cycle", sim::between(1, 65536),
          Affects::kTiming);
  }

  /// Returns the bytes of configuration memory that a kernel with initiation interval `ii` needs.
  std::uint64_t config_bytes(std::uint32_t ii) const {
    return std::uint64_t{ii} * array.unit_count() * config_word.bytes;
  }
  /// Returns the cycles to load the configuration of a kernel with initiation interval `ii`.
  std::uint64_t load_cycles(std::uint32_t ii) const {
    return (config_bytes(ii) + config_load.bytes - 1) / config_load.bytes;
  }

  /// Returns the bytes of SRAM in the shader core, which determine its leakage. The tile buffer is not included.
  std::uint64_t sram_bytes() const { return data_cache.size.bytes + kernel_data.bytes + config_memory.bytes; }
};

}  // namespace hw
