#pragma once
#include <cstdint>
#include <string>

#include "hw_models/frame/ideal_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/dram_config.h"
#include "hw_models/memory/l2_config.h"
#include "hw_models/srp/srp_config.h"
#include "hw_models/srp/tile_buffer.h"
#include "hw_models/tni/tni_config.h"
#include "sim/config/field.h"

namespace hw {

/// Clock domains on the chip; the memory's own clock comes with its grade.
struct ClockConfig {
  sim::Frequency tni{500'000'000};
  sim::Frequency srp{1'000'000'000};
  sim::Frequency l2{500'000'000};
  std::uint32_t synchroniser = 2;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.tni, "tni", "Hz", "traversal & intersection units", sim::between(1e6, 1e10), Affects::kTiming);
    field(c.srp, "srp", "Hz", "shader cores, tile buffers and DMA", sim::between(1e6, 1e10), Affects::kTiming);
    field(c.l2, "l2", "Hz", "L2, interconnect and tile dispatcher", sim::between(1e6, 1e10), Affects::kTiming);
    field(c.synchroniser, "synchroniser", "cycles", "cycles of the receiving clock to cross into its domain",
          sim::between(0, 16), Affects::kTiming);
  }
};

/// The streaming path between SRP and T&I unit, which keeps rays and hits out of memory; or the way through memory.
struct DirectInterfaceConfig {
  bool enabled = true;
  std::uint32_t depth = 64;
  std::uint32_t interval = 2;
  std::uint32_t ray_bytes = 64;
  std::uint32_t hit_bytes = 32;
  std::uint32_t ring = 16384;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(c.enabled, "enabled", "", "off: rays and hits are written to memory and read back", sim::any(),
          Affects::kTiming);
    field(c.depth, "depth", "records", "FIFO slots, each way; off: records that are read ahead, too",
          sim::between(1, 4096), Affects::kTiming);
    field(c.interval, "interval", "cycles", "T&I cycles from one record to the next, each way", sim::between(1, 64),
          Affects::kTiming);
    field(c.ray_bytes, "ray_bytes", "bytes", "of a ray in memory, if off", sim::between(8, 256), Affects::kTiming);
    field(c.hit_bytes, "hit_bytes", "bytes", "of a hit in memory, if off", sim::between(8, 256), Affects::kTiming);
    field(c.ring, "ring", "records", "room in memory for rays, and for as many hits, of each core, if off",
          sim::between(1, 65536), Affects::kTiming);
  }
  void check(auto&& complain) const {
    const auto pieces = [&](const char* key, std::uint32_t bytes) {
      if (bytes % 8 != 0)
        complain(key, "records are made of 8-byte pieces; " + std::to_string(bytes) + " is no multiple");
    };
    pieces("ray_bytes", ray_bytes);
    pieces("hit_bytes", hit_bytes);
  }
};

struct DmaConfig {
  std::uint32_t depth = 8;

  static void describe(auto& c, auto&& field) {
    field(c.depth, "depth", "lines", "line requests on their way into the interconnect", sim::between(1, 1024),
          sim::Affects::kTiming);
  }
};

/// The machine.
struct GpuConfig {
  std::uint32_t cores = 4;
  ClockConfig clocks;
  TniConfig tni;
  DirectInterfaceConfig direct_interface;
  SrpConfig srp;
  TileBufferConfig tile_buffer;
  DmaConfig dma;
  L2Config l2;
  InterconnectConfig interconnect;
  DramConfig dram;
  IdealConfig ideal;

  static void describe(auto& c, auto&& field) {
    field(c.cores, "cores", "cores", "pairs of an SRP and a T&I unit", sim::between(1, 64), sim::Affects::kTiming);
    field.group(c.clocks, "clocks", "clock domains");
    field.group(c.tni, "tni", "traversal & intersection unit, one per core");
    field.group(c.direct_interface, "direct_interface", "path between SRP and T&I unit");
    field.group(c.srp, "srp", "shader core, one per core");
    field.group(c.tile_buffer, "tile_buffer", "on-chip memory for the tiles in flight, one per core");
    field.group(c.dma, "dma", "block transfers between tile buffer and memory, one per core");
    field.group(c.l2, "l2", "second-level cache, shared");
    field.group(c.interconnect, "interconnect", "between cores, L2 and memory");
    field.group(c.dram, "dram", "memory channels");
    field.group(c.ideal, "ideal", "resources made perfect, for bounds (--ideal)");
  }
  void check(auto&& complain) const {
    const auto line = [&](const char* key, const sim::ByteSize& size) {
      if (size.bytes != 64)
        complain(key, "must be 64 B: nodes, attributes and texture tiles are laid out in such lines");
    };
    line("tni.trv.l1.line", tni.trv.l1.line);
    line("tni.ist.l1.line", tni.ist.l1.line);
    line("srp.data_cache.line", srp.data_cache.line);
    line("l2.line", l2.cache.line);
    line("dram.line", dram.line);
    if (cores + l2.banks > kMostWays) {
      complain("cores", "a memory channel takes requests from " + std::to_string(kMostWays) +
                            " cores and L2 banks at most, not from " + std::to_string(cores) + " + " +
                            std::to_string(l2.banks));
    }
  }
  static constexpr std::uint32_t kMostWays = 64;
};

}  // namespace hw
