#pragma once
#include <cstdint>
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

/// Gives a machine blocks of a frame's tiles, back to back, and takes its counters where their measured parts begin
/// and end.
///
///   front end --> tiles of a block ----------------------------------> tile dispatcher
///             \-> tiles before it --> caches warmed, in no time          | dispatched: marks
///
/// A measured part lasts from the dispatch of its first tile to that of the next block's first, or to the end.
class SampledTiles final : public hw::TileSource {
 public:
  /// The machine at some time.
  struct Mark {
    sim::Time time = 0;
    std::vector<sim::UnitReport> units;
    std::vector<hw::KernelUse> kernels;
  };
  /// A tile that was played.
  struct Played {
    std::uint32_t tile = 0;
    sim::Time begin = 0, end = 0;  ///< dispatched; given back, or when the next one was dispatched
  };

  /// `blocks` in order, without overlap.
  SampledTiles(hw::TileSource& source, std::span<const TimedBlock> blocks) : source_(source), blocks_(blocks) {}
  /// Must be called before the machine runs.
  void connect(hw::Gpu& gpu) { gpu_ = &gpu; }

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;
  void dispatched(sim::Time now) override;

  /// Where measured parts begin and end, two for each block; the last one's end is that of the run.
  const std::vector<Mark>& marks() const { return marks_; }
  const std::vector<Played>& played() const { return played_; }
  /// Call once, when the machine is finished.
  void finish();
  std::uint64_t warmed() const { return warmed_; }
  double warming_seconds() const { return warming_seconds_; }

 private:
  void mark(sim::Time now);
  void warm();

  hw::TileSource& source_;
  const std::span<const TimedBlock> blocks_;
  hw::Gpu* gpu_ = nullptr;
  std::size_t block_ = 0;                             ///< that next() is at
  std::vector<const traces::TileWork*> for_warming_;  ///< tiles before the block that comes
  std::vector<std::uint32_t> waiting_;                ///< tiles handed out by next() and not dispatched: one
  std::size_t dispatched_block_ = 0;                  ///< block of the tile dispatched last
  std::vector<std::uint32_t> back_;                   ///< given back since the last dispatch
  std::vector<Mark> marks_;
  std::vector<Played> played_;
  std::uint64_t warmed_ = 0;
  double warming_seconds_ = 0;
};

}  // namespace tools
