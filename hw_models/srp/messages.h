#pragma once
#include <cstddef>
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// A tile handed to a core; or news for a tile that the core has, once another border that it imports is there.
struct TileJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t missing = 0;  ///< borders that are not in memory yet: a bit for each of TileWork::imports
  TileTag owner = kNoTile;
};
static_assert(traces::kMostImports <= 32 && traces::kMostBorders <= 8);

/// A border of a tile is in memory; or the core is through with the tile: all its rays, launches and transfers.
struct TileDone {
  const traces::TileWork* work = nullptr;
  std::uint32_t border = traces::WorkNode::kNone;  ///< kNone: all of the tile
  TileTag owner = kNoTile;
};

inline constexpr std::size_t kAreas = static_cast<std::size_t>(Area::kCount);
inline constexpr std::size_t kRegions = static_cast<std::size_t>(traces::Region::kCount);
static_assert(kAreas == kRegions + 1);
constexpr Area area_of(traces::Region region) { return static_cast<Area>(region); }
static_assert(area_of(traces::Region::kPicture) == Area::kPicture &&
              area_of(traces::Region::kSamples) == Area::kSamples && area_of(traces::Region::kRates) == Area::kRates);

/// A block to be moved between the tile buffer and memory.
struct DmaJob {
  Addr base = 0;
  std::uint32_t bytes = 0;
  bool write = true;      ///< to memory
  std::uint32_t tag = 0;  ///< returned when done
  Area area = Area::kPicture;
  std::uint32_t encode_cycles = 0;  ///< that a line's pixels take to be sRGB-encoded on the way; 0: not at all
  TileTag owner = kNoTile;
};

struct DmaDone {
  std::uint32_t tag = 0;
};

/// A node for the core's rasteriser.
struct RasterJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t node = 0;
  std::uint32_t tag = 0;  ///< returned when done
  TileTag owner = kNoTile;
};

struct RasterDone {
  std::uint32_t tag = 0;
};

}  // namespace hw
