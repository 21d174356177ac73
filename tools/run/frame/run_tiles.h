#pragma once
#include <cstdint>

#include "hw_models/frame/tile_dispatcher.h"
#include "tools/host/progress.h"
#include "tools/host/run_watcher.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/kept_work.h"

namespace hw {
class Gpu;
}
namespace traces {
class TraceWriter;
}

namespace tools {

/// Sums over earlier front ends that executed tiles of the same frame.
struct FormerTiles {
  std::uint32_t tiles = 0;
  std::uint64_t rays = 0, cycles = 0;
  /// Reports the sums as progress.
  void end(Progress* progress) const {
    if (progress != nullptr) progress->tiles_done(tiles, rays, cycles);
  }
};

/// Passes tiles from the front end to the machine, reports progress and records the work. After an interrupt, next()
/// throws Interrupted or, with `keep_part`, ends the list: the machine finishes the tiles that it has.
class RunTiles final : public hw::TileSource {
 public:
  /// `tiles`: number of tiles. `former`: sums over earlier tiles of the same progress part, which this object
  /// continues.
  RunTiles(FrontEnd& front_end, std::uint32_t tiles, Progress* progress, bool keep_part = false,
           FormerTiles* former = nullptr)
      : front_end_(front_end), tiles_(tiles), progress_(progress), keep_part_(keep_part), former_(former) {}

  /// Records the work of each tile; either argument may be null.
  void record_to(traces::TraceWriter* trace, KeptWork* kept) { trace_ = trace, kept_ = kept; }
  void begin(const char* phase, std::uint32_t frame) const;
  void played_by(const hw::Gpu& gpu) { gpu_ = &gpu; }
  void watched_by(RunWatcher* watcher) { watcher_ = watcher; }
  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;
  std::uint32_t finished() const { return finished_; }

 private:
  FrontEnd& front_end_;
  const std::uint32_t tiles_;
  Progress* const progress_;
  const bool keep_part_;
  FormerTiles* const former_;
  const hw::Gpu* gpu_ = nullptr;
  RunWatcher* watcher_ = nullptr;
  traces::TraceWriter* trace_ = nullptr;
  KeptWork* kept_ = nullptr;
  std::uint32_t finished_ = 0;
};

}  // namespace tools
