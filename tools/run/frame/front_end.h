#pragma once
#include <array>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "hw_models/frame/tile_dispatcher.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "tools/host/progress.h"
#include "traces/accel/ray_predictor.h"
#include "traces/ray.h"

namespace hw {
class Gpu;
}

namespace traces {
class TraceWriter;
}

namespace tools {

class InMemoryTrace;

/// Results of a frame program that do not depend on the machine: picture, and counts of work.
struct RenderResult {
  std::vector<float> rgb;                  ///< linear RGB by rows; set after the last tile or by finish_picture()
  kernels::Sampling sampling;              ///< statistics of adaptive sampling; set together with rgb
  std::vector<kernels::SampleMark> marks;  ///< marks of the samples, if the program keeps them; set together with rgb
  kernels::TileSummaries summaries;        ///< summaries of the tiles that next() has returned, if costs are itemised
  /// Work of each pixel (rays, traversal steps, tests) by rows, if costs are itemised; empty for a program without a
  /// picture.
  std::vector<kernels::PixelWork> pixels;
  std::uint64_t rays[static_cast<std::size_t>(traces::RayKind::kCount)] = {};
  std::uint64_t continued = 0;  ///< rays that continued after passing a transparent surface
  std::uint64_t traversal_steps = 0;
  double seconds = 0;           ///< host seconds of rendering, summed over threads
  double waited = 0;            ///< host seconds in which the caller of FrontEnd::next() was blocked
  double next_cpu_seconds = 0;  ///< processor time of the calling thread in FrontEnd::next()
  std::uint64_t all_rays() const;
  /// Adds the counts of another frame. The picture and the data of tiles and pixels remain those of this frame.
  void add(const RenderResult& other);
};

/// Executes a frame program tile by tile, in the order of the tile list, and keeps the picture. Worker threads run
/// ahead of the machine by a bounded number of tiles and bytes. The results are independent of the number of threads.
/// If the tracer has a ray predictor, a recorded tile starts only after the tile `lag` before it has been committed.
class FrontEnd final : public hw::TileSource {
 public:
  /// `workers`: threads in addition to the caller's; 0: next() executes tiles. `record`: also record the work for a
  /// machine. `tile_indices`: entries of the tile list to execute, in this order, for a program of one pass; empty:
  /// all. `itemised`: keep the costs of each tile and pixel.
  FrontEnd(kernels::FrameProgram& program, const traces::Tracer& tracer, std::uint32_t workers, bool record = true,
           std::vector<std::uint32_t> tile_indices = {}, bool itemised = false);
  ~FrontEnd() override;
  FrontEnd(const FrontEnd&) = delete;
  FrontEnd& operator=(const FrontEnd&) = delete;

  const traces::TileWork* next() override;
  void release_work(const traces::TileWork* work) override;
  const RenderResult& result() const { return result_; }
  /// Returns the picture of the tiles that next() has returned so far.
  const std::vector<float>& picture_so_far() const { return result_.rgb.empty() ? program_.picture() : result_.rgb; }
  /// Sets the picture in result() for an unfinished frame. next() must not be called afterwards.
  void finish_picture();

 private:
  struct Slot {
    kernels::TileResult tile;
    std::optional<traces::TilePredictions> predictions;  ///< what the tile's rays look up, if they are predicted
    double seconds = 0;
    std::uint64_t bytes = 0;  ///< size of the tile's arrays, set when the tile is ready
    bool ready = false;
    std::exception_ptr failure;  ///< exception thrown by the execution of the tile
  };
  void run_ahead();
  bool can_execute_ahead() const {
    constexpr std::uint64_t kMaxBytes = 256U << 20;
    return next_tile_ < pass_end_ && ahead_.size() < max_ahead_ && ahead_bytes_ < kMaxBytes &&
           (!predictions_ || next_tile_ < predictions_->end_of_startable());
  }
  const traces::TileWork* take_tile();
  /// Returns a free tile slot for the tile `next_tile_`. Its arrays are as large as any tile has needed so far, so that
  /// later tiles do not allocate.
  std::unique_ptr<Slot> take_slot();
  /// Executes a tile. `buffer`: scratch memory of the thread, shared by its tiles.
  void execute_tile(Slot& slot, std::uint32_t tile, kernels::TileBuffer& buffer) const;
  void commit_slot(const Slot& slot);
  void add_tile_costs(const kernels::TileResult& tile);
  std::uint32_t tile_count() const {
    return tile_indices_.empty() ? program_.tiles() : static_cast<std::uint32_t>(tile_indices_.size());
  }
  std::uint32_t tile_index(std::uint32_t i) const { return tile_indices_.empty() ? i : tile_indices_[i]; }

  kernels::FrameProgram& program_;
  const traces::Tracer& tracer_;
  const bool record_, itemised_;
  const std::vector<std::uint32_t> tile_indices_;
  std::optional<traces::PredictorHistory> predictions_;  ///< if the tracer's rays are predicted and recorded
  RenderResult result_;
  std::mutex mutex_;
  std::condition_variable room_, news_;
  std::vector<std::unique_ptr<Slot>> ahead_;   ///< tiles executed ahead: in execution or finished, in tile order
  std::vector<std::unique_ptr<Slot>> handed_;  ///< tiles that the machine holds
  std::vector<std::unique_ptr<Slot>> spare_;
  std::uint64_t ahead_bytes_ = 0;          ///< size of the finished tiles that next() has not returned
  std::size_t slots_ = 0;                  ///< number of slots in ahead_, handed_ and spare_
  std::array<std::size_t, 14> longest_{};  ///< maximum sizes of the arrays of a tile so far
  kernels::TileBuffer buffer_;             ///< scratch memory of the thread that calls next()
  std::uint32_t next_tile_ = 0;
  std::uint32_t taken_ = 0;
  std::uint32_t pass_end_ = 0;  ///< end of the current pass; only tiles before it may be executed
  std::size_t max_ahead_;
  bool stop_ = false;
  std::exception_ptr failure_;  ///< exception thrown when a slot for next_tile_ was allocated
  std::vector<std::thread> threads_;
};

/// Tiles, rays and cycles of the front ends that have already executed a part of a frame. The progress of the frame
/// starts from these sums when the next front end takes over.
struct ProgressBase {
  std::uint32_t tiles = 0;
  std::uint64_t rays = 0, cycles = 0;
  /// Reports the sums in this object as the progress of the frame; no effect if `progress` is null.
  void report_to(Progress* progress) const {
    if (progress != nullptr) progress->set_tiles_done(tiles, rays, cycles);
  }
};

/// Passes tiles from the front end to the machine, reports progress and records the work. After an interrupt, next()
/// throws Interrupted. With `keep_part` it returns no more tiles instead, and the machine finishes the dispatched ones.
class RunTiles final : public hw::TileSource {
 public:
  /// `tiles`: number of tiles that the front end executes. `former`: progress of earlier RunTiles of the same frame,
  /// which is added to the displayed progress; null if one RunTiles passes all tiles of the frame.
  RunTiles(FrontEnd& front_end, std::uint32_t tiles, Progress* progress, bool keep_part = false,
           ProgressBase* former = nullptr)
      : front_end_(front_end), tiles_(tiles), progress_(progress), keep_part_(keep_part), former_(former) {}

  /// Sets the objects that record the work of each tile; either argument may be null.
  void set_recorders(traces::TraceWriter* trace, InMemoryTrace* kept) { trace_ = trace, kept_ = kept; }
  void begin_part(const char* phase, std::uint32_t frame) const;
  void set_gpu(const hw::Gpu& gpu) { gpu_ = &gpu; }
  const traces::TileWork* next() override;
  void release_work(const traces::TileWork* work) override;
  std::uint32_t finished_tiles() const { return finished_; }

 private:
  FrontEnd& front_end_;
  const std::uint32_t tiles_;
  Progress* const progress_;
  const bool keep_part_;
  ProgressBase* const former_;
  const hw::Gpu* gpu_ = nullptr;
  traces::TraceWriter* trace_ = nullptr;
  InMemoryTrace* kept_ = nullptr;
  std::uint32_t finished_ = 0;
};

}  // namespace tools
