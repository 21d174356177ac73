#pragma once
#include <cstdint>

#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Receives the samples of a program's tiles in place of the frame buffer.
class PixelSink {
 public:
  virtual ~PixelSink() = default;
  /// Selects in `retained` the records that the sink needs. Called after launch `generated` has written `rays` primary
  /// rays of the tile, which has `samples` samples with those of its halo.
  virtual void begin_rays(TileGraph& graph, TileGraph::Node generated, std::uint32_t rays, std::uint32_t samples,
                          TileResult& out, RetainedRecords& retained) const = 0;
  /// Writes the tile, which has `samples` samples, `per_pixel` for each pixel in turn.
  virtual void write_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel, TileResult& out) const = 0;
  /// Writes the tile, whose pixels have one sample each, those of `lattice`.
  virtual void write_grid(TileGraph& graph, const LatticeUniforms<float>& lattice, TileResult& out) const = 0;
  /// Returns the first byte of region kSamples that the program itself may use.
  virtual std::uint64_t memory_end() const = 0;
};

}  // namespace kernels
