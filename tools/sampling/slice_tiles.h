#pragma once
#include <cstdint>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "tools/sampling/slice_plan.h"

namespace tools {

/// Gives a machine the tiles of a slice and those before it that fill the machine, warms its caches, takes its counters
/// where the slice and its probes begin and end, and stops it when the tile behind the slice is dispatched.
class SliceTiles final : public hw::TileSource {
 public:
  /// The machine at the dispatch of a tile.
  struct Mark {
    std::uint32_t tile = 0;
    sim::Time time = 0;
    std::vector<sim::UnitReport> units;
    std::vector<hw::KernelUse> kernels;
  };

  /// `source` has the tiles from the slice's begin() to the one behind it. The frame's last slice has none behind it.
  SliceTiles(hw::TileSource& source, const Slice& slice, std::uint32_t probe, bool is_last);
  /// Must be called before the machine runs.
  void connect(hw::Gpu& gpu) { gpu_ = &gpu; }

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override { source_.give_back(work); }
  void dispatched(sim::Time now) override;

  /// Host: processor time that making tiles took of the machine's thread.
  double making_seconds() const { return making_seconds_; }

  /// The mark at a border of the slice, or as many tiles before it as the probe has.
  const Mark& at(std::uint32_t tile) const;

 private:
  const traces::TileWork* take();
  void warm();

  hw::TileSource& source_;
  const Slice slice_;
  hw::Gpu* gpu_ = nullptr;
  std::uint32_t next_, dispatched_;     ///< tiles
  std::vector<std::uint32_t> to_mark_;  ///< tiles at whose dispatch counters are taken
  std::vector<const traces::TileWork*> for_warming_;
  std::vector<Mark> marks_;
  double making_seconds_ = 0;
};

}  // namespace tools
