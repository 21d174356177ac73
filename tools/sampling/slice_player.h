#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "shader_kernels/programs/wavefront/frame_program.h"
#include "tools/host/interrupt.h"
#include "tools/host/progress.h"
#include "tools/run/frame/front_end.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/tile_plan.h"
#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Time and counters of a machine between two points in time.
struct MachineSpan {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;

  MachineSpan() = default;
  explicit MachineSpan(const hw::Gpu& gpu)
      : time(gpu.elapsed_time()), units(gpu.unit_reports()), kernels(gpu.kernel_use()) {}
  explicit MachineSpan(const Mark& mark) : time(mark.time), units(mark.units), kernels(mark.kernels) {}
  void subtract_mark(const Mark& earlier);
  void add(const MachineSpan& other);
};

/// Cost of the tiles that two machines simulate.
struct Probe {
  double time = 0, energy_pj = 0;
};

/// Results of one slice.
struct PlayedSlice {
  Slice slice;
  MachineSpan own;
  Probe before, after;  ///< probes at the ends of its lead and of its own tiles, where there is a border
  double seconds = 0, timing_seconds = 0;  ///< host processor time of its thread: total, and without executing tiles
};

/// A frame program that several threads execute concurrently. Each tile is committed and counted once.
class SharedFrame {
 public:
  SharedFrame(kernels::FrameProgram& program, Progress* progress) : program_(program), progress_(progress) {}
  const kernels::FrameProgram& frame_program() const { return program_; }

  void commit_tile(const kernels::TileResult& tile) {
    const std::lock_guard lock(mutex_);
    program_.commit_tile(tile);
    for (std::size_t k = 0; k < std::size(result_.rays); ++k) result_.rays[k] += tile.rays[k];
    result_.continued += tile.continued;
    result_.traversal_steps += tile.traversal_steps;
    tiles_ += 1;
    if (progress_ != nullptr) progress_->set_tiles_done(tiles_, result_.all_rays(), 0);
  }
  /// Adds the host times of one thread.
  void add_times(const RenderResult& rendered) {
    const std::lock_guard lock(mutex_);
    result_.seconds += rendered.seconds;
    result_.waited += rendered.waited;
  }
  /// Returns the results after all threads have finished.
  RenderResult take_result() {
    result_.rgb = program_.take_picture();
    result_.sampling = program_.sampling();
    return std::move(result_);
  }

 private:
  kernels::FrameProgram& program_;
  Progress* const progress_;
  std::mutex mutex_;
  RenderResult result_;
  std::uint32_t tiles_ = 0;
};

/// View of a shared frame for one slice, which commits only the slice's own tiles. Throws Interrupted.
class SliceProgram final : public kernels::FrameProgram {
 public:
  SliceProgram(SharedFrame& frame, const Slice& slice) : FrameProgram(0, 0), frame_(frame), slice_(slice) {}

  std::uint32_t tiles() const override { return frame_.frame_program().tiles(); }
  kernels::FrameRequirements requirements() const override { return frame_.frame_program().requirements(); }
  void run_tile(std::uint32_t tile_index, const traces::Tracer& tracer, bool record,
                kernels::TileResult& out) const override {
    if (is_interrupted()) throw Interrupted{};
    frame_.frame_program().run_tile(tile_index, tracer, record, out);
  }
  void commit_tile(const kernels::TileResult& tile) override {
    if (slice_.has_tile(tile.work.tile)) frame_.commit_tile(tile);
  }

 private:
  SharedFrame& frame_;
  const Slice slice_;
};

/// Simulates slices of a frame, each on a machine of its own.
class SlicePlayer {
 public:
  /// `frame`: program of the frame. `inputs` must outlive the player.
  SlicePlayer(const Inputs& inputs, const kernels::FrameProgram& frame);

  const Inputs& inputs() const { return inputs_; }
  const SliceShape& plan_shape() const { return shape_; }
  const std::vector<hw::KernelSchedule>& kernel_schedules() const { return scheduled_->kernels; }
  std::uint32_t tile_count() const { return tiles_; }

  /// Simulates one slice; thread-safe for different slices. `workers` threads render ahead. sim::Deadlock, Interrupted.
  PlayedSlice run_slice(SharedFrame& frame, const traces::Tracer& tracer, const Slice& slice,
                        std::uint32_t workers) const;
  /// Counters of a machine before its first cycle.
  MachineSpan initial_state() const;

 private:
  std::unique_ptr<hw::Gpu> make_machine(hw::TileSource& tiles) const;
  Probe measure_probe(const TimedTiles& tiles, std::uint32_t border) const;

  const Inputs& inputs_;
  const kernels::FrameRequirements requirements_;
  const std::uint32_t tiles_;
  const SliceShape shape_;
  const std::shared_ptr<const hw::ScheduledKernels> scheduled_;
};
}  // namespace tools
