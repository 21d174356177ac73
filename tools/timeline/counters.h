#pragma once
#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/recorder.h"
#include "tools/timeline/tracks.h"

namespace tools {

/// Writes figures over the whole frame, a value for each stretch of it: `DRAM read` and `DRAM write` in GB/s, `L2 hits`
/// in % of what was looked up, `power` in W of nominal energy, of cores `SRP busy` in % of the time, and `rays in T&I`
/// whenever a batch begins or ends. A tile's energy is taken as spent evenly while it was in flight, the rest evenly
/// over the frame.
void write_counters(const TimelineRecorder& recorder, const FrameResult& s, const TileFrame& tiles,
                    const RunConfig& config, TimelineTracks& tracks, TracePackets& to);

}  // namespace tools
