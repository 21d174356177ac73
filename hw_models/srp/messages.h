#pragma once
#include <cstddef>
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// Message to a core: a new tile, or the borders that a tile in the core still waits for.
struct TileJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t missing = 0;  ///< borders that are not in memory yet: a bit for each of TileWork::imports
  TileTag tile = kNoTile;
};
static_assert(traces::kMostImports <= 32 && traces::kMostBorders <= 8);

/// Message that a border of a tile is in memory, or that a core has finished all rays, launches and transfers of the
/// tile.
struct TileDone {
  const traces::TileWork* work = nullptr;
  std::uint32_t border = traces::WorkNode::kNone;  ///< kNone: the whole tile is finished
  TileTag tile = kNoTile;
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
  bool write = true;      ///< from the tile buffer to memory
  std::uint32_t tag = 0;  ///< returned when the job is done
  Area area = Area::kPicture;
  std::uint32_t encode_cycles = 0;  ///< cycles to sRGB-encode a line's pixels on the way; 0: no encoding
  TileTag tile = kNoTile;
};

struct DmaDone {
  std::uint32_t tag = 0;
};

/// A node of a tile's work for the core's rasteriser.
struct RasterJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t node = 0;
  std::uint32_t tag = 0;  ///< returned when the job is done
  TileTag tile = kNoTile;
};

struct RasterDone {
  std::uint32_t tag = 0;
};

}  // namespace hw
