#pragma once
#include "tools/simulation/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// Tiles of a frame that was itemised. A replay has no columns x, y, width and height: a trace has no picture.
TileFrame tile_frame(const Simulation& s, const RunConfig& config, std::uint32_t frame);

}  // namespace tools
