#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "tools/run/run_plan.h"
#include "tools/run/run_result.h"
#include "tools/timeline/timeline_job.h"

namespace tools {

/// Source of the frames of a run: rendered from a scene, read from a trace, or joined from slices. Frames are visited
/// in order.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Configuration and scene of the current frame.
  virtual const Inputs& inputs() const = 0;
  /// Number of frames.
  virtual std::uint32_t count() const { return inputs().frames(); }
  /// True if each frame is simulated as a whole on one machine.
  virtual bool has_whole_frames() const { return true; }
  virtual bool has_reference() const = 0;
  /// Simulations of each frame; all but the first are perturbed (docs/noise.md).
  virtual std::uint32_t replicates() const { return 1; }
  /// Simulates the current frame, or the reference program on it.
  virtual FrameResult play(const SimulateOptions& extras) = 0;
  virtual FrameResult play_reference(const SimulateOptions& extras) = 0;
  /// Returns the mean squared difference of the current frame's pictures.
  virtual double squared_error(const FrameResult& frame, const FrameResult& reference) const = 0;
  /// Advances to the next frame; false after the last.
  virtual bool advance() = 0;
};

/// Frames of a scene; advancing updates `inputs`.
class PosedFrames : public FrameSource {
 public:
  PosedFrames(Inputs& inputs, std::uint32_t threads, Progress* progress)
      : inputs_(inputs), threads_(threads), progress_(progress) {}
  const Inputs& inputs() const override { return inputs_; }
  bool advance() override { return tools::advance(inputs_, threads_, progress_); }

 protected:
  Inputs& inputs_;
  const std::uint32_t threads_;
  Progress* const progress_;
};

/// Frames rendered from the scene. Host threads render tiles ahead of the simulated machine.
class RenderedFrames final : public PosedFrames {
 public:
  /// InputError if the frames cannot be split into the plan's slices.
  RenderedFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress);
  /// Number of concurrent slices; 1 for a whole frame.
  std::uint32_t slices() const { return std::max(1U, slices_); }
  bool has_whole_frames() const override;
  bool has_reference() const override { return plan_.whole() != nullptr && plan_.whole()->reference; }
  std::uint32_t replicates() const override { return plan_.whole() != nullptr ? plan_.whole()->replicates : 1; }
  FrameResult play(const SimulateOptions& extras) override;
  FrameResult play_reference(const SimulateOptions& extras) override;
  double squared_error(const FrameResult& frame, const FrameResult& reference) const override;

 private:
  const RunPlan plan_;
  std::uint32_t slices_ = 0;  ///< per frame; 0 if the plan has none
  kernels::RateMap rates_, reference_rates_;
};

/// A finished frame, before it is added to the run's result.
struct PlayedFrame {
  const Inputs& inputs;
  const FrameResult& frame;
  const FrameResult* reference = nullptr;
  const TileFrame* tiles = nullptr;  ///< with RunOptions::itemised
  bool is_first = true;
};

/// Observers of a run, and what an interrupt keeps.
struct RunOptions {
  Progress* progress = nullptr;
  bool keep_part = false;  ///< an interrupt keeps the finished tiles of the first frame
  bool intervals = false;  ///< record counters over time
  bool itemised = false;   ///< keep the costs of each tile and pixel
  RunWatcher* live = nullptr;
  TimelineJob* timeline = nullptr;       ///< records the first frame
  traces::TraceWriter* trace = nullptr;  ///< receives the work
  std::function<void(const PlayedFrame&)> on_frame = {};
};

/// Simulates all frames of a source: the frame loop of runs, replays, baselines and sweep points. After an interrupt
/// the result is partial: the finished frames, or with `keep_part` a part of the first. Interrupted if there is nothing
/// to keep.
RunResult run(FrameSource& frames, const RunOptions& options);

/// Returns the report of all frames of `inputs`, without pictures. Uses the program, reference, replicates and threads
/// of `options`. Interrupted.
sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
