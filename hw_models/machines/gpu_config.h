#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "hw_models/build/tree_builder_config.h"
#include "hw_models/dram/dram_config.h"
#include "hw_models/frame/direct_interface_config.h"
#include "hw_models/memory/background_source.h"
#include "hw_models/memory/cache_config.h"
#include "hw_models/memory/core_port.h"
#include "hw_models/memory/system_cache.h"
#include "hw_models/raster/raster_unit_config.h"
#include "hw_models/srp/srp_config.h"
#include "hw_models/srp/tile_buffer.h"
#include "hw_models/tni/tni_config.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Selects hardware resources that are simulated as ideal: they cost no time. A run with an ideal resource bounds the
/// gain from better hardware of that kind.
struct IdealConfig {
  bool tni = false;
  bool l1 = false;
  bool l2 = false;
  bool dram = false;
  bool srp = false;
  bool tile_buffer = false;
  bool interconnect = false;

  struct Resource {
    const char* name;
    const char* words;  ///< name of the resource for use in sentences, a plural noun phrase
    bool IdealConfig::*member;
    const char* meaning;
  };
  static const std::array<Resource, 7> kResources;

  static void describe(auto& c, auto&& field) {
    for (const Resource& r : kResources) {
      field(c.*r.member, r.name, "", r.meaning, sim::any(), sim::Affects::kTiming);
    }
  }
};

inline constexpr std::array<IdealConfig::Resource, 7> IdealConfig::kResources = {{
    {"tni", "T&I units", &IdealConfig::tni,
     "T&I units do any number of operations per cycle, each in one cycle, on 64 rays per traversal unit; their caches "
     "are unchanged"},
    {"l1", "first-level caches", &IdealConfig::l1, "every probe of a node, triangle or data cache hits"},
    {"l2", "L2 banks", &IdealConfig::l2, "every look-up hits; any number per cycle, each in one cycle"},
    {"dram", "memory channels", &IdealConfig::dram,
     "channels take any number of requests per cycle and answer each one cycle later"},
    {"srp", "shader cores", &IdealConfig::srp,
     "kernels take no time and no switches; they still wait for data-cache misses"},
    {"tile_buffer", "tile buffers", &IdealConfig::tile_buffer, "unlimited ray slots and accesses per cycle"},
    {"interconnect", "core ports and wires", &IdealConfig::interconnect,
     "any number of requests and lines per cycle, each in one cycle"},
}};

/// Configuration of the clock domains of the chip. The DRAM clock is part of the DRAM configuration.
struct ClockConfig {
  sim::Frequency tni{500'000'000};
  sim::Frequency srp{1'000'000'000};
  sim::Frequency l2{500'000'000};
  std::uint32_t synchroniser = 2;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field(NAMED(c.tni), "Hz", "traversal & intersection units", sim::between(1e6, 1e10), Affects::kTiming);
    field(NAMED(c.srp), "Hz", "shader cores, tile buffers and DMA", sim::between(1e6, 1e10), Affects::kTiming);
    field(NAMED(c.l2), "Hz", "L2, interconnect and tile dispatcher", sim::between(1e6, 1e10), Affects::kTiming);
    field(NAMED(c.synchroniser), "cycles", "cycles of the receiving clock added to each crossing between clock domains",
          sim::between(0, 16), Affects::kTiming);
  }
};

struct DmaConfig {
  std::uint32_t depth = 8;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.depth), "lines", "line requests in the queue to the interconnect", sim::between(1, 1024),
          sim::Affects::kTiming);
  }
};

/// Configuration of the whole GPU.
struct GpuConfig {
  std::uint32_t cores = 4;
  ClockConfig clocks;
  TniConfig tni;
  DirectInterfaceConfig direct_interface;
  SrpConfig srp;
  TileBufferConfig tile_buffer;
  RasterUnitConfig raster;
  TreeBuilderConfig tree_builder;
  DmaConfig dma;
  L2Config l2;
  InterconnectConfig interconnect;
  SystemCacheConfig slc;
  BackgroundConfig background;
  DramConfig dram;
  IdealConfig ideal;
  std::uint64_t watchdog = 0;

  static void describe(auto& c, auto&& field) {
    field(NAMED(c.cores), "cores", "pairs of an SRP and a T&I unit", sim::between(1, 64), sim::Affects::kTiming);
    field.group(NAMED(c.clocks), "clock domains");
    field.group(NAMED(c.tni), "traversal & intersection unit, one per core");
    field.group(NAMED(c.direct_interface), "path between SRP and T&I unit");
    field.group(NAMED(c.srp), "shader core, one per core");
    field.group(NAMED(c.tile_buffer), "on-chip memory for the tiles in flight, one per core");
    field.group(NAMED(c.raster), "rasteriser, one per core, if the frame has work for it (render.primary)");
    field.group(NAMED(c.tree_builder),
                "unit that builds and refits trees, if the frame has work for it (build.engine)");
    field.group(NAMED(c.dma), "block transfers between tile buffer and memory, one per core");
    field.group(NAMED(c.l2), "second-level cache, shared");
    field.group(NAMED(c.interconnect), "between cores, L2 and memory");
    field.group(NAMED(c.slc), "system cache, a slice in front of each memory channel");
    field.group(NAMED(c.background), "traffic of the rest of the chip on the memory channels");
    field.group(NAMED(c.dram), "memory channels");
    field.group(NAMED(c.ideal), "ideal resources, for upper bounds (--ideal)");
    field(NAMED(c.watchdog), "cycles",
          "T&I cycles without a retired item after which the run ends as stuck; 0: eight times the longest latency of "
          "an item",
          sim::between(0, 1e9), sim::Affects::kTiming);
  }
  void check(auto&& complain) const {
    const auto line = [&](const char* key, const sim::ByteSize& size) {
      if (size.bytes != kLineBytes)
        complain(key, "must be 64 B: nodes, attributes and texture tiles are laid out in such lines");
    };
    line("tni.trv.l1.line", tni.trv.l1.line);
    line("tni.ist.l1.line", tni.ist.l1.line);
    line("srp.data_cache.line", srp.data_cache.line);
    line("raster.l1.line", raster.l1.line);
    line("tree_builder.buffer.line", tree_builder.buffer.line);
    line("l2.line", l2.cache.line);
    line("dram.line", dram.line);
    if (slc.is_present()) {
      slc.slice_config(dram.channels).check([&](std::string_view key, const std::string& problem) {
        complain("slc." + std::string(key == "banks" ? "size" : key), problem);
      });
    }
    const std::uint32_t sources = background.rate > 0 ? 1 : 0;
    if (cores + l2.banks + sources > kMostWays) {
      complain("cores", "a memory channel takes requests from " + std::to_string(kMostWays) +
                            " cores and L2 banks at most, not from " + std::to_string(cores) + " + " +
                            std::to_string(l2.banks) + (sources > 0 ? " and the background" : ""));
    }
  }
  static constexpr std::uint32_t kMostWays = 64;
};

}  // namespace hw
