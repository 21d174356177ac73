#pragma once
#include <array>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "hw_models/frame/tile_dispatcher.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/ray.h"

namespace tools {

/// The functional half of a run: executes a frame program tile by tile, in order, and keeps the picture. With worker
/// threads it runs ahead of the machine by a bounded number of tiles and bytes; what it delivers does not depend on
/// them.
class FrontEnd final : public hw::TileSource {
 public:
  /// Results of the frame program, independent of any machine.
  struct Result {
    std::vector<float> rgb;      ///< linear, row by row; there when the last tile has been taken or by keep_picture()
    kernels::Sampling sampling;  ///< likewise
    std::vector<kernels::SampleMark> marks;  ///< likewise, if the program keeps them
    kernels::TileSummaries summaries;        ///< those of tiles taken so far, if wanted
    std::vector<kernels::PixelWork> pixels;  ///< likewise, row by row; none of a program without a picture
    std::uint64_t rays[static_cast<std::size_t>(traces::RayKind::kCount)] = {};
    std::uint64_t continued = 0;  ///< rays that went on behind what was no solid surface
    std::uint64_t traversal_steps = 0;
    double seconds = 0;  ///< host time of the functional half, summed over its threads
    double waited = 0;   ///< time of that for which the caller of next() stood still
    std::uint64_t all_rays() const;
    /// Adds another frame's figures; the picture, and what is per tile, stay.
    void add(const Result& other);
  };

  /// `workers` threads beside the caller's; 0: tiles are made when they are asked for. Without `record` there is only
  /// the picture, no work for a machine. `tile_indices` of a program of one pass: the entries to make, in order, all
  /// others are left out; empty: all. `itemised`: what each tile and each pixel took is kept.
  FrontEnd(kernels::FrameProgram& program, const traces::Tracer& tracer, std::uint32_t workers, bool record = true,
           std::vector<std::uint32_t> tile_indices = {}, bool itemised = false);
  ~FrontEnd() override;
  FrontEnd(const FrontEnd&) = delete;
  FrontEnd& operator=(const FrontEnd&) = delete;

  const traces::TileWork* next() override;
  void give_back(const traces::TileWork* work) override;
  const Result& result() const { return result_; }
  /// The picture of the tiles taken so far.
  const std::vector<float>& picture() const { return result_.rgb.empty() ? program_.picture() : result_.rgb; }
  /// Has the result show what has been taken so far, for a frame that is left unfinished. Nothing may be taken after
  /// it.
  void keep_picture();

 private:
  struct Slot {
    kernels::TileResult tile;
    double seconds = 0;
    std::uint64_t bytes = 0;  ///< sum over its arrays, when it is ready
    bool ready = false;
    std::exception_ptr failure;  ///< why it could not be made
  };
  void run_ahead();
  bool may_make() const {
    constexpr std::uint64_t kMaxBytes = 256U << 20;
    return next_tile_ < pass_end_ && ahead_.size() < max_ahead_ && ahead_bytes_ < kMaxBytes;
  }
  const traces::TileWork* take();
  /// A spare one if there is any, with room for all that tiles have needed so far: soon none allocates any more.
  std::unique_ptr<Slot> take_slot();
  /// `buffer` is the thread's: tiles need it while they are made, and one that stays warm serves all of them.
  void make(Slot& slot, std::uint32_t tile, kernels::TileBuffer& buffer) const;
  void keep(const Slot& slot);
  void itemise(const kernels::TileResult& tile);
  std::uint32_t count() const {
    return tile_indices_.empty() ? program_.tiles() : static_cast<std::uint32_t>(tile_indices_.size());
  }
  std::uint32_t tile_index(std::uint32_t i) const { return tile_indices_.empty() ? i : tile_indices_[i]; }

  kernels::FrameProgram& program_;
  const traces::Tracer& tracer_;
  const bool record_, itemised_;
  const std::vector<std::uint32_t> tile_indices_;
  Result result_;
  std::mutex mutex_;
  std::condition_variable room_, news_;
  std::vector<std::unique_ptr<Slot>> ahead_;   ///< tiles being made or made, in order
  std::vector<std::unique_ptr<Slot>> handed_;  ///< out in the machine
  std::vector<std::unique_ptr<Slot>> spare_;
  std::uint64_t ahead_bytes_ = 0;          ///< sum over those that are made and not taken
  std::size_t slots_ = 0;                  ///< in all of these
  std::array<std::size_t, 13> longest_{};  ///< arrays of any tile so far
  kernels::TileBuffer buffer_;             ///< for the thread that calls next()
  std::uint32_t next_tile_ = 0;
  std::uint32_t taken_ = 0;
  std::uint32_t pass_end_ = 0;  ///< tiles before it may be made
  std::size_t max_ahead_;
  bool stop_ = false;
  std::exception_ptr failure_;  ///< why there is no slot for next_tile_
  std::vector<std::thread> threads_;
};

}  // namespace tools
