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
  std::uint64_t slices = 0;   ///< in it
  std::uint64_t dropped = 0;  ///< that were asked for and had no room
};

/// Shows what cores did while selected tiles were worked on: all of it, for what a tile waits for is often another's. A
/// process stands for each core, with a track for its shader core, tracks for batches of rays as many as overlap, one
/// for its DMA and one for each slot of a tile; one more, `shared`, has the counters of L2, memory and power. A flow
/// goes through each tile's slices. Where there is no room for all, slices of the first selected tiles go first, and
/// with all of them selected the earliest.
Timeline make_timeline(const TimelineRecorder& recorder, const TimelineSelection& selection, const FrameResult& s,
                       const TileFrame& tiles, const RunConfig& config, std::uint64_t most_bytes = kMostTimelineBytes);

}  // namespace tools
