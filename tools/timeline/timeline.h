#pragma once
#include <cstdint>
#include <string>

#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/recorder.h"
#include "tools/timeline/selection.h"

namespace tools {

inline constexpr const char* kTimelineFile = "timeline.pftrace";
inline constexpr std::uint64_t kMostTimelineBytes = std::uint64_t{32} << 20;

/// A frame as a Perfetto trace.
struct Timeline {
  std::string bytes;
  std::uint64_t slices = 0;   ///< slices in the trace
  std::uint64_t dropped = 0;  ///< selected slices for which there was no room
};

/// Exports all activity of cores during the selected tiles (dependencies may be in other tiles).
///
/// 1. Each core is a process with tracks for its shader core, for overlapping batches of rays, for its DMA and for each
///    tile slot. One more process, `shared`, has the counters of L2, memory and power.
/// 2. A flow connects each tile's slices.
/// 3. If room is short, slices of the first selected tiles have priority; if all tiles are selected, the earliest
///    slices have.
Timeline make_timeline(const TimelineRecorder& recorder, const TimelineSelection& selection, const FrameResult& s,
                       const TileFrame& tiles, const RunConfig& config, std::uint64_t most_bytes = kMostTimelineBytes);

}  // namespace tools
