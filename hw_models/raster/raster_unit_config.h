#pragma once
#include <algorithm>
#include <cstdint>
#include <string>

#include "hw_models/srp/srp_config.h"
#include "sim/config/field.h"
#include "sim/named.h"

namespace hw {

/// Configuration of a core's rasteriser.
struct RasterUnitConfig {
  DataCacheConfig l1{{.size = {16 * 1024}, .mshrs = 16}};
  std::uint32_t lookups = 2;
  std::uint32_t window = 32;
  std::uint32_t jobs = 4;
  std::uint32_t vertex_cache = 32;
  std::uint32_t vertex_interval = 2;
  std::uint32_t setup_interval = 1;
  std::uint32_t list_interval = 1;
  std::uint32_t queue = 16;
  std::uint32_t block_interval = 1;
  std::uint32_t quad_interval = 1;
  std::uint32_t sub_samples = 4;
  bool hierarchical_z = true;
  sim::ByteSize depth_buffer{8 * 1024};
  std::uint32_t depth_bytes = 8;
  std::uint32_t plane_bytes = 16;
  sim::ByteSize plane_width{64};
  std::uint32_t write_buffer = 8;

  static void describe(auto& c, auto&& field) {
    using sim::Affects;
    field.group(NAMED(c.l1), "cache of vertices, lists and triangles' vertex numbers");
    field(NAMED(c.lookups), "lines", "lines looked up in its cache per cycle", sim::between(1, 8), Affects::kTiming);
    field(NAMED(c.window), "triangles", "triangles whose lines are fetched at the same time", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.jobs), "jobs",
          "jobs (waves of a tile, batches of triangles) that it holds; lines of later jobs are prefetched",
          sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.vertex_cache), "vertices", "recently transformed vertices that triangles of the same batch reuse",
          sim::between(1, 4096), Affects::kTiming);
    field(NAMED(c.vertex_interval), "cycles", "cycles between two vertices to be transformed", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.setup_interval), "cycles", "cycles between two triangles to be set up", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.list_interval), "cycles", "cycles between two entries of lists", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.queue), "triangles", "triangles set up that wait for coverage or lists", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.block_interval), "cycles", "cycles between two blocks of coarse coverage", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.quad_interval), "cycles", "cycles between two quads of fine coverage", sim::between(1, 1024),
          Affects::kTiming);
    field(NAMED(c.sub_samples), "samples", "samples of each pixel of a quad that are tested in one pass",
          sim::between(1, 64), Affects::kTiming);
    field(NAMED(c.hierarchical_z), "", "blocks that nearer surfaces cover completely are skipped before fine coverage",
          sim::any(), Affects::kTiming);
    field(NAMED(c.depth_buffer), "bytes",
          "storage of depth and nearest triangle for the samples of a wave; larger waves take several passes",
          sim::between(64, 1 << 20), Affects::kTiming);
    field(NAMED(c.depth_bytes), "bytes", "bytes of depth and nearest triangle per sample", sim::between(1, 64),
          Affects::kTiming);
    field(NAMED(c.plane_bytes), "bytes", "bytes written to the tile buffer per sample: its hit, and planes if any",
          sim::between(16, 256), Affects::kTiming);
    field(NAMED(c.plane_width), "bytes", "bytes written to the tile buffer per cycle", sim::between(16, 1024),
          Affects::kTiming);
    field(NAMED(c.write_buffer), "lines", "lines waiting to be written to memory", sim::between(4, 256),
          Affects::kTiming);
  }
  void check(auto&& complain) const {
    l1.check([&](const char* key, const std::string& what) { complain((std::string("l1.") + key).c_str(), what); });
    if (depth_buffer.bytes < depth_bytes) complain("depth_buffer", "holds not one sample's depth_bytes");
  }

  /// Returns the number of parts in which a wave of `wave_samples` samples is processed to fit into the depth buffer.
  std::uint64_t depth_buffer_parts(std::uint64_t wave_samples) const {
    const std::uint64_t part = depth_buffer.bytes / depth_bytes;
    return std::max<std::uint64_t>(1, (wave_samples + part - 1) / part);
  }
  /// Bytes of a transformed vertex in the rasteriser's vertex cache.
  static constexpr std::uint32_t kVertexBytes = 16;
  /// Bytes of a triangle in the rasteriser's window or queue: three vertices and a description.
  static constexpr std::uint32_t kTriangleBytes = 64;
  std::uint64_t sram_bytes() const {
    return l1.size.bytes + depth_buffer.bytes + std::uint64_t{vertex_cache} * kVertexBytes +
           (std::uint64_t{window} + queue) * kTriangleBytes + write_buffer * kLineBytes;
  }
};

}  // namespace hw
