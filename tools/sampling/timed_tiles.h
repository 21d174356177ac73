#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "traces/stream.h"

namespace tools {

/// Consecutive tiles [first, end) of a frame to simulate. Tiles [measured, end) are measured; tiles [first, measured)
/// only fill the machine. `warming` tiles before `first` warm the caches.
struct TimedBlock {
  std::uint32_t first = 0, measured = 0, end = 0;
  std::uint32_t warming = 0;
};

/// Time and counters that a machine had when a certain tile was dispatched.
struct Mark {
  std::uint32_t tile = 0;
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;
};

/// Passes blocks of a frame's tiles to a machine, one after the other, and records its counters when the tiles in
/// `marked` are dispatched.
///
///   front end --> tiles of a block ------------------------------> tile dispatcher
///             \-> tiles before it --> warm the caches at once      | dispatched: marks
class TimedTiles final : public hw::TileSource {
 public:
  /// A simulated tile and the times of its dispatch and end.
  struct TimedTile {
    std::uint32_t tile = 0;
    sim::Time begin = 0, end = 0;  ///< time of dispatch; time of completion, or of the first dispatch after it
  };

  /// `blocks` must be in tile order and must not overlap. `marked`: tiles, in ascending order, at whose dispatch the
  /// machine's counters are recorded. The machine stops at the dispatch of tile `stop_at`.
  TimedTiles(hw::TileSource& source, std::vector<TimedBlock> blocks, std::vector<std::uint32_t> marked,
             std::optional<std::uint32_t> stop_at = std::nullopt);
  /// Sets the machine that receives the tiles; call it before the machine runs.
  void set_gpu(hw::Gpu& gpu) { gpu_ = &gpu; }

  const traces::TileWork* next() override;
  void release_work(const traces::TileWork* work) override;
  void note_dispatched(sim::Time now) override;
  /// Sets the end time of tiles that are still in flight. Call it once, after the machine has finished.
  void finish_tile_times();

  /// Returns the time and counters that were recorded at the dispatch of a tile in `marked`.
  const Mark& snapshot_at(std::uint32_t tile) const;
  const std::vector<TimedTile>& simulated_tiles() const { return simulated_; }
  std::uint64_t warmed_tiles() const { return warmed_; }
  /// Returns the host time for warming caches.
  double warming_seconds() const { return warming_seconds_; }

 private:
  void warm_caches();

  hw::TileSource& source_;
  const std::vector<TimedBlock> blocks_;
  const std::vector<std::uint32_t> marked_;
  const std::optional<std::uint32_t> stop_at_;
  hw::Gpu* gpu_ = nullptr;
  std::size_t block_ = 0;                             ///< block from which next() takes tiles
  std::vector<const traces::TileWork*> for_warming_;  ///< warming tiles of the next block
  std::vector<std::uint32_t> waiting_;  ///< tiles that next() returned and that are not dispatched; at most one
  std::size_t dispatched_block_ = 0;    ///< block of the tile dispatched last
  std::vector<std::uint32_t> back_;     ///< tiles completed since the last dispatch
  std::vector<Mark> marks_;
  std::vector<TimedTile> simulated_;
  std::uint64_t warmed_ = 0;
  double warming_seconds_ = 0;
};

}  // namespace tools

namespace hw {
struct GpuConfig;
}

namespace tools {

/// Plan of a sampled frame: the blocks of tiles to simulate.
struct TilePlan {
  std::vector<TimedBlock> blocks;  ///< the first block is the start of the frame, the last is its end
  bool all = false;                ///< true: one block has all tiles, because the frame is too small to sample
  /// Tiles [begin, end) of the frame are estimated from the blocks within this range.
  std::uint32_t begin = 0, end = 0;
};

struct PlanShape {
  std::uint32_t edge = 24;      ///< tiles simulated at the start of the frame, and at its end
  std::uint32_t lead = 4;       ///< tiles of a block before its measured part
  std::uint32_t measured = 12;  ///< tiles of a block's measured part
  std::uint32_t warming = 8;    ///< tiles before a block that warm the caches
  std::uint32_t least = 28;     ///< minimum number of blocks
};

/// Returns the number of tiles that warm the caches of a machine before a block.
std::uint32_t warming_tiles(const hw::GpuConfig& gpu, std::uint32_t tile_samples);

/// Plans blocks whose measured parts are `share` of the frame's cost. The tile list is split into strata of equal cost,
/// and one block per stratum starts at a tile drawn with `seed` and probability proportional to `costs`.
TilePlan plan_tiles(std::span<const double> costs, double share, const PlanShape& shape, std::uint64_t seed);

/// A slice: consecutive tiles [first, end) of a frame that one of several machines simulates.
///
///   warming tiles | lead ........ probe | first .............. probe | end
///   caches only   | fills the machine   | counted                    | dispatched; the machine is stopped
///
/// Time and counters are measured from the dispatch of `first` to the dispatch of `end`. The first slice starts, and
/// the last slice ends, like a whole frame.
struct Slice {
  std::uint32_t first = 0, end = 0;
  std::uint32_t lead = 0, warming = 0;
  std::uint32_t lead_begin() const { return first - lead; }
  std::uint32_t begin() const { return first - lead - warming; }
  bool has_tile(std::uint32_t tile) const { return tile >= first && tile < end; }
};

struct SliceShape {
  std::uint32_t lead = 0;  ///< tiles of a short lead, which fills the machine; also the minimum length of a slice
  /// Last tiles of a slice's lead. The machine of the previous slice simulates them, too, as its last tiles.
  std::uint32_t probe = 0;
  std::uint32_t warming = 0;  ///< tiles before a slice that warm the caches, including the slice's lead
};

SliceShape slice_shape(const hw::GpuConfig& gpu, const traces::FrameRequirements& requirements);

/// Splits a frame's tiles into `count` slices of nearly equal cost, each of at least SliceShape::lead tiles. Leads of
/// short slices and small frames are twice as long.
std::vector<Slice> plan_slices(std::span<const double> costs, std::uint32_t count, const SliceShape& shape);

}  // namespace tools
