#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Which tiles of a frame are timed.
struct TilePlan {
  std::vector<TimedBlock> blocks;  ///< the first and the last are the frame's own begin and end
  bool all = false;                ///< every tile, in one block: the frame is too small to sample
  /// Tiles [begin, end) are those that the blocks between stand for.
  std::uint32_t begin = 0, end = 0;
};

struct PlanShape {
  std::uint32_t edge = 24;      ///< tiles at the frame's begin and at its end
  std::uint32_t lead = 4;       ///< tiles of a block before its measured part
  std::uint32_t measured = 12;  ///< tiles of its measured part
  std::uint32_t warming = 8;    ///< tiles before a block that warm the caches
  std::uint32_t least = 28;     ///< blocks
};

/// Tiles before others that warm the caches of a machine for them.
std::uint32_t warming_tiles(const hw::GpuConfig& gpu, std::uint32_t tile_samples);

/// Blocks whose measured parts come to `share` of the frame's cost, where each tile costs `costs`. The list of tiles is
/// cut into as many strata of equal cost, and a block begins at a tile of each, drawn by hash from `seed` with
/// chances in proportion to cost.
TilePlan plan_tiles(std::span<const double> costs, double share, const PlanShape& shape, std::uint64_t seed);

}  // namespace tools
