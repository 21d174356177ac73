#pragma once
#include <mutex>
#include <utility>

#include "shader_kernels/programs/wavefront/frame_program.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/run/frame/front_end.h"
#include "tools/sampling/slice_plan.h"

namespace tools {

/// A frame program that several threads execute concurrently. Each tile is committed and counted once.
class SharedFrame {
 public:
  SharedFrame(kernels::FrameProgram& program, Progress* progress) : program_(program), progress_(progress) {}
  const kernels::FrameProgram& program() const { return program_; }

  void commit_tile(const kernels::TileResult& tile) {
    const std::lock_guard lock(mutex_);
    program_.commit_tile(tile);
    for (std::size_t k = 0; k < std::size(function_.rays); ++k) function_.rays[k] += tile.rays[k];
    function_.continued += tile.continued;
    function_.traversal_steps += tile.traversal_steps;
    tiles_ += 1;
    if (progress_ != nullptr) progress_->tiles_done(tiles_, function_.all_rays(), 0);
  }
  /// Adds the host times of one thread.
  void add_times(const FrontEnd::Result& function) {
    const std::lock_guard lock(mutex_);
    function_.seconds += function.seconds;
    function_.waited += function.waited;
  }
  /// Returns the results after all threads have finished.
  FrontEnd::Result take_function() {
    function_.rgb = program_.take_picture();
    function_.sampling = program_.sampling();
    return std::move(function_);
  }

 private:
  kernels::FrameProgram& program_;
  Progress* const progress_;
  std::mutex mutex_;
  FrontEnd::Result function_;
  std::uint32_t tiles_ = 0;
};

/// View of a shared frame for one slice, which commits only the slice's own tiles. Throws Interrupted.
class SliceProgram final : public kernels::FrameProgram {
 public:
  SliceProgram(SharedFrame& frame, const Slice& slice) : FrameProgram(0, 0), frame_(frame), slice_(slice) {}

  std::uint32_t tiles() const override { return frame_.program().tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.program().requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (interrupted()) throw Interrupted{};
    frame_.program().run_tile(tile_index, tracer, record, out);
  }
  void commit_tile(const kernels::TileResult& tile) override {
    if (slice_.owns(tile.work.tile)) frame_.commit_tile(tile);
  }

 private:
  SharedFrame& frame_;
  const Slice slice_;
};

}  // namespace tools
