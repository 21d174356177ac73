#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/run/frame/run_job.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/recorder.h"

namespace tools {

/// Tiles that a timeline shows, as given to `--timeline`.
struct TimelineSelection {
  enum class Kind : std::uint8_t { kAll, kSlowest, kTile, kPixel };
  Kind kind = Kind::kAll;
  std::uint32_t count = 0;     ///< kSlowest
  std::uint32_t x = 0, y = 0;  ///< kTile: column and row of the tile; kPixel: of the picture
  bool needs_places() const { return kind == Kind::kTile || kind == Kind::kPixel; }
};

/// Parses "all", "slowest:8", "tile:3,2" or "pixel:200,100"; throws InputError for other texts.
TimelineSelection parse_timeline(const std::string& text);

/// Returns the rows of the selected tiles, the most important first; a tile of several passes has several rows. The
/// slowest tiles have the most cycles from dispatch to end; of equal ones the earlier is first. Throws InputError if
/// there is no such tile.
std::vector<std::size_t> selected_tiles(const TimelineSelection& selection, const TileFrame& tiles);

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
