#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "hw_models/machines/gpu.h"
#include "tools/run/frame/run_job.h"
#include "tools/sampling/slice_plan.h"
#include "tools/sampling/slice_program.h"
#include "tools/sampling/timed_tiles.h"

namespace tools {

/// Time and counters of a machine between two points in time.
struct Stretch {
  sim::Time time = 0;
  std::vector<sim::UnitReport> units;
  std::vector<hw::KernelUse> kernels;

  Stretch() = default;
  explicit Stretch(const hw::Gpu& gpu) : time(gpu.elapsed()), units(gpu.report()), kernels(gpu.kernel_use()) {}
  explicit Stretch(const Mark& mark) : time(mark.time), units(mark.units), kernels(mark.kernels) {}
  void take_off(const Mark& earlier);
  void add(const Stretch& other);
};

/// Cost of the tiles that two machines simulate.
struct Probe {
  double time = 0, energy_pj = 0;
};

/// Results of one slice.
struct PlayedSlice {
  Slice slice;
  Stretch own;
  Probe before, after;  ///< probes at the ends of its lead and of its own tiles, where there is a border
  double seconds = 0, timing_seconds = 0;  ///< host processor time of its thread: total, and without executing tiles
};

/// Simulates slices of a frame, each on a machine of its own.
class SlicePlayer {
 public:
  /// `frame`: program of the frame. `inputs` must outlive the player.
  SlicePlayer(const Inputs& inputs, const kernels::FrameProgram& frame);

  const Inputs& inputs() const { return inputs_; }
  const SliceShape& shape() const { return shape_; }
  const std::vector<hw::KernelSchedule>& kernels() const { return scheduled_->kernels; }
  std::uint32_t tiles() const { return tiles_; }

  /// Simulates one slice; thread-safe for different slices. `workers` threads render ahead. sim::Deadlock, Interrupted.
  PlayedSlice play(SharedFrame& frame, const traces::Tracer& tracer, const Slice& slice, std::uint32_t workers) const;
  /// Counters of a machine before its first cycle.
  Stretch nothing() const;

 private:
  std::unique_ptr<hw::Gpu> machine(hw::TileSource& tiles) const;
  Probe probe(const TimedTiles& tiles, std::uint32_t border) const;

  const Inputs& inputs_;
  const kernels::FrameRequirements requirements_;
  const std::uint32_t tiles_;
  const SliceShape shape_;
  const std::shared_ptr<const hw::ScheduledKernels> scheduled_;
};

}  // namespace tools
