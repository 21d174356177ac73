#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/tiles/tile_table.h"

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

}  // namespace tools
