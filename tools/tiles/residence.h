#pragma once
#include <optional>
#include <span>
#include <vector>

#include "hw_models/memory/tile_accounting.h"

namespace tools {

/// Shares of a frame's time by who was there: at any time those tiles that a core has, or, without a core, those that
/// any has, share it evenly. The rest is time in which there were none.
struct Residence {
  std::vector<double> tiles;  ///< 0 of those that are elsewhere
  double rest = 0;
};
Residence residence(std::span<const hw::TileAccount> tiles, sim::Time elapsed, std::optional<std::uint32_t> core);

}  // namespace tools
