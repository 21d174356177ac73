#pragma once
#include "traces/stream.h"
#include "traces/trace_file/bytes.h"

namespace traces {

/// Appends what a rasteriser's node has beside its items: runs of lists, then triangles.
void write_raster(const TileWork& work, const WorkNode& node, ByteWriter& to);

/// Reads it behind what is in `work`, whose entry in TileWork::raster says how much there is. InputError, without the
/// file's name, for what no frame with these demands has.
void read_raster(ByteReader& from, const RasterDemands& demands, const WorkNode& node, TileWork& work);

}  // namespace traces
