#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "tools/sampling/timed_tiles.h"
#include "traces/stream.h"

namespace hw {
struct GpuConfig;
}

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

/// Consecutive tiles [first, end) of a frame that one of several machines simulates.
///
///   warming tiles | lead ........ probe | first .............. probe | end
///   caches only   | fills the machine   | counted                    | dispatched; the machine is stopped
///
/// Time and counters count from the dispatch of `first` to that of `end`. The first slice starts, and the last slice
/// ends, like a whole frame.
struct Slice {
  std::uint32_t first = 0, end = 0;
  std::uint32_t lead = 0, warming = 0;
  std::uint32_t lead_begin() const { return first - lead; }
  std::uint32_t begin() const { return first - lead - warming; }
  bool has_tile(std::uint32_t tile) const { return tile >= first && tile < end; }
};

struct SliceShape {
  std::uint32_t lead = 0;     ///< length of a short lead, which fills the machine; the minimum length of a slice
  std::uint32_t probe = 0;    ///< tiles at the end of the lead that the previous machine simulates as its last
  std::uint32_t warming = 0;  ///< tiles before a slice that warm the caches, including its lead
};

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements);

/// Splits a frame's tiles into `count` slices of equal cost, as far as each has at least the minimum length. Leads of
/// short slices and small frames are twice as long.
std::vector<Slice> plan_slices(std::span<const double> costs, std::uint32_t count, const SliceShape& shape);

}  // namespace tools
