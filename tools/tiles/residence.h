#pragma once
#include <optional>
#include <span>
#include <vector>

#include "hw_models/memory/tile_accounting.h"

namespace tools {

/// Shares of a frame's time by tile: at any time the tiles in flight on a core (or on any core, if none is given) share
/// the time equally. The rest is time without tiles.
struct Residence {
  std::vector<double> tiles;  ///< 0 for tiles of other cores
  double rest = 0;
};
Residence residence(std::span<const hw::TileAccount> tiles, sim::Time elapsed, std::optional<std::uint32_t> core);

}  // namespace tools
