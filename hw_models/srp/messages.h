#pragma once
#include <cstddef>
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// Message from the tile dispatcher to a core: a new tile, or an update of the borders for which a tile waits.
struct TileJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t missing = 0;  ///< imported borders that are not in memory yet, as a mask over TileWork::imports
  TileTag tile = kNoTile;
};
static_assert(traces::kMostImports <= 32 && traces::kMostBorders <= 8);

/// Message from a core to the tile dispatcher: a border of a tile is in memory, or the tile is finished.
struct TileDone {
  const traces::TileWork* work = nullptr;
  std::uint32_t border = traces::WorkNode::kNone;  ///< number of the border that is in memory; kNone: the whole tile is
                                                   ///< finished
  TileTag tile = kNoTile;
};

inline constexpr std::size_t kAreas = static_cast<std::size_t>(Area::kCount);
inline constexpr std::size_t kRegions = static_cast<std::size_t>(traces::Region::kCount);
static_assert(kAreas == kRegions + 1);
constexpr Area area_of(traces::Region region) { return static_cast<Area>(region); }
static_assert(area_of(traces::Region::kPicture) == Area::kPicture &&
              area_of(traces::Region::kSamples) == Area::kSamples && area_of(traces::Region::kRates) == Area::kRates);

/// Job for a DMA engine: a block to be moved between the tile buffer and memory.
struct DmaJob {
  Addr base = 0;
  std::uint32_t bytes = 0;
  bool write = true;      ///< direction of the DMA transfer; true: from the tile buffer to memory
  std::uint32_t tag = 0;  ///< value returned when the job is done
  Area area = Area::kPicture;
  std::uint32_t encode_cycles = 0;  ///< cycles for sRGB-encoding the pixels of a line; 0: no encoding
  TileTag tile = kNoTile;
};

struct DmaDone {
  std::uint32_t tag = 0;
};

/// Job for a core's rasteriser: one node of the work graph of a tile.
struct RasterJob {
  const traces::TileWork* work = nullptr;
  std::uint32_t node = 0;
  std::uint32_t tag = 0;  ///< value returned when the job is done
  TileTag tile = kNoTile;
};

struct RasterDone {
  std::uint32_t tag = 0;
};

}  // namespace hw
