#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"

namespace tools {

/// Consecutive tiles [first, end) of a frame to simulate. Tiles from `measured` on count; those before it fill the
/// machine. `warming` tiles before `first` warm the caches.
struct TimedBlock {
  std::uint32_t first = 0, measured = 0, end = 0;
  std::uint32_t warming = 0;
};

/// Time and counters of a machine at the dispatch of a tile.
struct Mark {
  std::uint32_t tile = 0;
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;
};

/// Passes blocks of a frame's tiles to a machine, one after the other, and samples its counters when marked tiles are
/// dispatched.
///
///   front end --> tiles of a block ------------------------------> tile dispatcher
///             \-> tiles before it --> warm the caches at once      | dispatched: marks
class TimedTiles final : public hw::TileSource {
 public:
  /// A tile that was simulated.
  struct TimedTile {
    std::uint32_t tile = 0;
    sim::Time begin = 0, end = 0;  ///< dispatch; completion, or the first dispatch after it
  };

  /// `blocks` and `marked` are in tile order, without overlap. The machine stops at the dispatch of tile `stop_at`.
  TimedTiles(hw::TileSource& source, std::vector<TimedBlock> blocks, std::vector<std::uint32_t> marked,
             std::optional<std::uint32_t> stop_at = std::nullopt);
  /// Call before the machine runs.
  void set_gpu(hw::Gpu& gpu) { gpu_ = &gpu; }

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;
  void note_dispatched(sim::Time now) override;
  /// Sets the end of tiles still in flight. Call once, after the machine has finished.
  void end_tiles();

  /// Returns the mark of a marked tile.
  const Mark& mark_at(std::uint32_t tile) const;
  const std::vector<TimedTile>& simulated_tiles() const { return simulated_; }
  std::uint64_t warmed_tiles() const { return warmed_; }
  /// Host time for warming caches, and processor time for executing tiles on the machine's thread.
  double warming_seconds() const { return warming_seconds_; }
  double making_seconds() const { return making_seconds_; }

 private:
  const traces::TileWork* take_tile();
  void warm_caches();

  hw::TileSource& source_;
  const std::vector<TimedBlock> blocks_;
  const std::vector<std::uint32_t> marked_;
  const std::optional<std::uint32_t> stop_at_;
  hw::Gpu* gpu_ = nullptr;
  std::size_t block_ = 0;                             ///< current block of next()
  std::vector<const traces::TileWork*> for_warming_;  ///< warming tiles of the next block
  std::vector<std::uint32_t> waiting_;  ///< tiles that next() returned and that are not dispatched; at most one
  std::size_t dispatched_block_ = 0;    ///< block of the tile dispatched last
  std::vector<std::uint32_t> back_;     ///< completed since the last dispatch
  std::vector<Mark> marks_;
  std::vector<TimedTile> simulated_;
  std::uint64_t warmed_ = 0;
  double warming_seconds_ = 0, making_seconds_ = 0;
};

}  // namespace tools
