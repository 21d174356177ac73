#pragma once
#include <cstdint>

#include "shader_kernels/programs/wavefront/tile_graph.h"
#include "shader_kernels/programs/wavefront/wavefront.h"

namespace kernels {

/// Receives the samples of a program's tiles in place of the frame buffer.
class PixelSink {
 public:
  virtual ~PixelSink() = default;
  /// Selects in `retained` the records that the sink needs. Called after launch `generated` has written the tile's
  /// `samples` primary rays.
  virtual void begin_tile(TileGraph& graph, TileGraph::Node generated, std::uint32_t samples, TileResult& out,
                          RetainedRecords& retained) const = 0;
  /// Writes the tile, which has `samples` samples, `per_pixel` for each pixel in turn.
  virtual void write_tile(TileGraph& graph, std::uint32_t samples, std::uint32_t per_pixel, TileResult& out) const = 0;
};

}  // namespace kernels
