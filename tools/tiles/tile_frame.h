#pragma once
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"

namespace tools {

/// Returns the tiles of an itemised frame. A replay has no columns x, y, width and height: a trace has no picture.
TileFrame tile_frame(const FrameResult& s, const RunConfig& config, std::uint32_t frame);

}  // namespace tools
