#pragma once
#include <cstdint>

#include "sim/named.h"

namespace hw {

/// Counters of a rasteriser.
struct RasterStats {
  std::uint64_t batches = 0, waves = 0;
  std::uint64_t triangles = 0, triangles_culled = 0, vertices_transformed = 0, vertices_reused = 0;
  std::uint64_t entries_written = 0, entries_read = 0, triangles_set_up = 0;
  std::uint64_t blocks = 0, blocks_hidden = 0, quads = 0, quads_hidden = 0, quad_passes = 0;
  std::uint64_t samples_covered = 0, samples_hidden = 0, samples_failed = 0, samples_passed = 0, samples_out = 0;
  std::uint64_t l1_accesses = 0, l1_hits = 0, l1_misses = 0, l1_fills = 0;
  std::uint64_t writes = 0;

  static void describe(auto& s, auto&& counter) {
    counter(NAMED(s.batches), "batches of triangles put into lists");
    counter(NAMED(s.waves), "waves of samples whose primary hits were found");
    counter(NAMED(s.triangles), "triangles of these batches");
    counter(NAMED(s.triangles_culled), "of these, triangles that show nowhere in the picture");
    counter(NAMED(s.vertices_transformed), "vertices transformed", "raster.vertex");
    counter(NAMED(s.vertices_reused), "vertices found in the vertex cache");
    counter(NAMED(s.entries_written), "entries of lists written", "raster.list_entry");
    counter(NAMED(s.entries_read), "entries of lists read");
    counter(NAMED(s.triangles_set_up), "triangles set up for coverage", "raster.setup");
    counter(NAMED(s.blocks), "blocks of pixels tested for coarse coverage", "raster.block");
    counter(NAMED(s.blocks_hidden), "of these, blocks that the hierarchical z buffer left out");
    counter(NAMED(s.quads), "quads tested for fine coverage");
    counter(NAMED(s.quads_hidden), "quads in blocks that were left out");
    counter(NAMED(s.quad_passes), "times that a quad's samples were tested, so many of a pixel at once", "raster.quad");
    counter(NAMED(s.samples_covered), "samples that triangles cover: those left out, failed and passed together");
    counter(NAMED(s.samples_hidden), "of these, samples in blocks that were left out");
    counter(NAMED(s.samples_failed), "of these, samples behind a nearer triangle", "raster.depth_test");
    counter(NAMED(s.samples_passed), "of these, samples nearer than all before", "raster.depth_write");
    counter(NAMED(s.samples_out), "samples that left for the tile buffer, with a hit or without", "raster.plane");
    counter(NAMED(s.l1_accesses), "probes of the L1, but for those that found no free miss register");
    counter(NAMED(s.l1_hits), "probes that found the line", "cache.l1_read");
    counter(NAMED(s.l1_misses), "probes that did not", "cache.l1_probe");
    counter(NAMED(s.l1_fills), "lines filled", "cache.l1_fill");
    counter(NAMED(s.writes), "lines or parts of lines written: vertices and lists");
  }
};

}  // namespace hw
