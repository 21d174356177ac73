#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "tools/run/run_plan.h"
#include "tools/run/run_result.h"
#include "tools/timeline/timeline_job.h"

namespace tools {

/// Where the frames of a run come from: rendered from a scene, read from a trace, or joined from slices. A run asks for
/// one frame after the other.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Configuration and scene as they are in the current frame.
  virtual const Inputs& inputs() const = 0;
  /// Frames of the run.
  virtual std::uint32_t count() const { return inputs().frames(); }
  /// True if every frame is played on one machine from its first tile to its last.
  virtual bool has_whole_frames() const { return true; }
  virtual bool has_reference() const = 0;
  /// Plays of each frame's work, all but the first perturbed (docs/noise.md).
  virtual std::uint32_t replicates() const { return 1; }
  /// Plays the current frame, or the reference program's.
  virtual FrameResult play(const SimulateOptions& extras) = 0;
  virtual FrameResult play_reference(const SimulateOptions& extras) = 0;
  /// Mean squared difference of the current frame's pictures.
  virtual double squared_error(const FrameResult& frame, const FrameResult& reference) const = 0;
  /// Goes to the next frame; false after the last.
  virtual bool advance() = 0;
};

/// Frames posed from the scene of `inputs`, which move on with them.
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

/// Frames rendered from the scene. Threads of the host render tiles ahead of the machine that simulates them.
class RenderedFrames final : public PosedFrames {
 public:
  /// InputError if frames of this configuration cannot be cut into the plan's slices.
  RenderedFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress);
  /// Slices that run side by side; 1 for a frame that is not cut.
  std::uint32_t slices() const { return std::max(1U, slices_); }
  bool has_whole_frames() const override;
  bool has_reference() const override { return plan_.whole() != nullptr && plan_.whole()->reference; }
  std::uint32_t replicates() const override { return plan_.whole() != nullptr ? plan_.whole()->replicates : 1; }
  FrameResult play(const SimulateOptions& extras) override;
  FrameResult play_reference(const SimulateOptions& extras) override;
  double squared_error(const FrameResult& frame, const FrameResult& reference) const override;

 private:
  const RunPlan plan_;
  std::uint32_t slices_ = 0;  ///< of each frame; 0 if the plan has none
  kernels::RateMap rates_, reference_rates_;
};

/// A finished frame, before its figures are added to the run's.
struct PlayedFrame {
  const Inputs& inputs;
  const FrameResult& frame;
  const FrameResult* reference = nullptr;
  const TileFrame* tiles = nullptr;  ///< with RunOptions::itemised
  bool is_first = true;
};

/// How frames are observed and what an interrupt leaves.
struct RunOptions {
  Progress* progress = nullptr;
  bool keep_part = false;  ///< an interrupt leaves the finished tiles of the first frame
  bool intervals = false;  ///< counters over time are kept
  bool itemised = false;   ///< costs of each tile and pixel are kept
  RunWatcher* live = nullptr;
  TimelineJob* timeline = nullptr;       ///< records the first frame
  traces::TraceWriter* trace = nullptr;  ///< records the work
  std::function<void(const PlayedFrame&)> on_frame = {};
};

/// Plays all frames of a source on the machine: the frame loop of runs, replays, baselines and sweep points. After an
/// interrupt the result is partial: it has the finished frames, or with `keep_part` a part of the first. Interrupted if
/// there is nothing to keep.
RunResult run(FrameSource& frames, const RunOptions& options);

/// The report of all frames of `inputs`, without pictures. Uses the program, the reference, the replicates and the
/// threads of `options`. Interrupted.
sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress = nullptr);

}  // namespace tools
