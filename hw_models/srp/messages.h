#pragma once
#include <cstdint>

#include "hw_models/memory/messages.h"
#include "traces/stream.h"

namespace hw {

/// A tile handed to a core.
struct TileJob {
  const traces::TileWork* work = nullptr;
};

/// The core is through with a tile: all its rays, launches and transfers.
struct TileDone {
  const traces::TileWork* work = nullptr;
};

/// A block to be moved between the tile buffer and memory.
struct DmaJob {
  Addr base = 0;
  std::uint32_t bytes = 0;
  bool write = true;      ///< to memory
  std::uint32_t tag = 0;  ///< returned when done
};

struct DmaDone {
  std::uint32_t tag = 0;
};

}  // namespace hw
