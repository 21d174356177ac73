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

/// Sums over the front ends that have made tiles of a frame so far, one after the other.
struct FormerTiles {
  std::uint32_t tiles = 0;
  std::uint64_t rays = 0, cycles = 0;
  /// Reports the sums when there are no more front ends.
  void end(Progress* progress) const {
    if (progress != nullptr) progress->tiles_done(tiles, rays, cycles);
  }
};

/// Tiles of a frame from the front end to the machine. Reports progress and records their work. After an interrupt it
/// throws Interrupted or, if the finished part is kept, ends the list: the machine finishes the tiles that it has.
class RunTiles final : public hw::TileSource {
 public:
  /// `tiles`: how many there are. With `former` they follow those, and are added to them; the part that `progress` is
  /// told of goes on until its end().
  RunTiles(FrontEnd& front_end, std::uint32_t tiles, Progress* progress, bool keep_part = false,
           FormerTiles* former = nullptr)
      : front_end_(front_end), tiles_(tiles), progress_(progress), keep_part_(keep_part), former_(former) {}

  /// Also writes the work of each tile there; either may be null.
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
