#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw_models/machines/gpu.h"

namespace tools {

/// Consecutive tiles of a frame that are timed: [first, end). Those from `measured` on count; those before fill the
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

/// Gives a machine blocks of a frame's tiles, one after the other, and takes its counters when marked tiles are
/// dispatched.
///
///   front end --> tiles of a block ----------------------------------> tile dispatcher
///             \-> tiles before it --> caches warmed, in no time          | dispatched: marks
class TimedTiles final : public hw::TileSource {
 public:
  /// A tile that was played.
  struct Played {
    std::uint32_t tile = 0;
    sim::Time begin = 0, end = 0;  ///< dispatched; given back, or when the next one was dispatched
  };

  /// `blocks` and `marked` tiles in order, without overlap. The machine stops at the dispatch of tile `stop_at`.
  TimedTiles(hw::TileSource& source, std::vector<TimedBlock> blocks, std::vector<std::uint32_t> marked,
             std::optional<std::uint32_t> stop_at = std::nullopt);
  /// Must be called before the machine runs.
  void connect(hw::Gpu& gpu) { gpu_ = &gpu; }

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;
  void dispatched(sim::Time now) override;
  /// Ends the tiles still in flight. Call once, when the machine is finished.
  void finish();

  /// The mark of a marked tile.
  const Mark& at(std::uint32_t tile) const;
  const std::vector<Played>& played() const { return played_; }
  std::uint64_t warmed() const { return warmed_; }
  /// Host time for warming caches, and processor time for making tiles on the machine's thread.
  double warming_seconds() const { return warming_seconds_; }
  double making_seconds() const { return making_seconds_; }

 private:
  const traces::TileWork* take();
  void warm();

  hw::TileSource& source_;
  const std::vector<TimedBlock> blocks_;
  const std::vector<std::uint32_t> marked_;
  const std::optional<std::uint32_t> stop_at_;
  hw::Gpu* gpu_ = nullptr;
  std::size_t block_ = 0;                             ///< that next() is at
  std::vector<const traces::TileWork*> for_warming_;  ///< tiles before the block that comes
  std::vector<std::uint32_t> waiting_;                ///< tiles handed out by next() and not dispatched: one
  std::size_t dispatched_block_ = 0;                  ///< block of the tile dispatched last
  std::vector<std::uint32_t> back_;                   ///< given back since the last dispatch
  std::vector<Mark> marks_;
  std::vector<Played> played_;
  std::uint64_t warmed_ = 0;
  double warming_seconds_ = 0, making_seconds_ = 0;
};

}  // namespace tools
