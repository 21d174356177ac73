#pragma once
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/recorder.h"
#include "tools/timeline/tracks.h"

namespace tools {

/// Writes counters over the whole frame, one value per bin:
///
/// - `DRAM read`, `DRAM write` in GB/s; `L2 hits` in % of lookups; `power` in W of nominal energy
/// - per core `SRP busy` in % of the time, and `rays in T&I` whenever a batch begins or ends
///
/// A tile's energy is spread evenly over its time in flight, the rest evenly over the frame.
void write_counters(const TimelineRecorder& recorder, const FrameResult& s, const TileFrame& tiles,
                    const RunConfig& config, TimelineTracks& tracks, TracePackets& to);

}  // namespace tools
