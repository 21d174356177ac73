#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sampling/timed_tiles.h"

namespace tools {

/// The tiles of a frame that are simulated.
struct TilePlan {
  std::vector<TimedBlock> blocks;  ///< the first and last are the start and end of the frame
  bool all = false;                ///< one block of all tiles: the frame is too small to sample
  /// Tiles [begin, end) are estimated from the blocks between.
  std::uint32_t begin = 0, end = 0;
};

struct PlanShape {
  std::uint32_t edge = 24;      ///< tiles at the start and at the end of the frame
  std::uint32_t lead = 4;       ///< tiles of a block before its measured part
  std::uint32_t measured = 12;  ///< tiles of its measured part
  std::uint32_t warming = 8;    ///< tiles before a block that warm the caches
  std::uint32_t least = 28;     ///< minimum number of blocks
};

/// Returns the number of tiles that warm the caches of a machine before a block.
std::uint32_t warming_tiles(const hw::GpuConfig& gpu, std::uint32_t tile_samples);

/// Plans blocks whose measured parts are `share` of the frame's cost. The tile list is split into strata of equal cost,
/// and one block per stratum starts at a tile drawn with `seed` and probability proportional to `costs`.
TilePlan plan_tiles(std::span<const double> costs, double share, const PlanShape& shape, std::uint64_t seed);

}  // namespace tools
