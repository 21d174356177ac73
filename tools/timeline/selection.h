#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tools/tiles/tile_table.h"

namespace tools {

/// Tiles that a timeline shows, as `--timeline` names them.
struct TimelineSelection {
  enum class Kind : std::uint8_t { kAll, kSlowest, kTile, kPixel };
  Kind kind = Kind::kAll;
  std::uint32_t count = 0;     ///< kSlowest
  std::uint32_t x = 0, y = 0;  ///< kTile: column and row of the tile; kPixel: of the picture
  bool needs_places() const { return kind == Kind::kTile || kind == Kind::kPixel; }
};

/// "all", "slowest:8", "tile:3,2", "pixel:200,100"; InputError otherwise.
TimelineSelection parse_timeline(const std::string& text);

/// Rows of the frame's tiles, the most wanted first; a tile of several passes has several. Of the slowest those with
/// the most cycles from dispatch to end, the earlier of equal ones. InputError if there is no such tile.
std::vector<std::size_t> selected_tiles(const TimelineSelection& selection, const TileFrame& tiles);

}  // namespace tools
