#pragma once
#include "traces/stream.h"
#include "traces/trace_file/bytes.h"

namespace traces {

/// Appends the data of a rasteriser node: list runs, then triangles.
void write_raster(const TileWork& work, const WorkNode& node, ByteWriter& to);

/// Counts of that data, stored with the node; reading adds an entry to TileWork::raster.
void write_raster_counts(const TileWork& work, const WorkNode& node, ByteWriter& to);
void read_raster_counts(ByteReader& from, WorkNode& node, TileWork& work);

/// Reads the data of a rasteriser node, whose counts are in TileWork::raster. Throws InputError, without a file name,
/// if the data exceed `demands`.
void read_raster(ByteReader& from, const RasterDemands& demands, const WorkNode& node, TileWork& work);

}  // namespace traces
