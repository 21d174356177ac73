#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "shader_kernels/programs/program_spec.h"
#include "sim/io/json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/intervals/intervals.h"
#include "tools/run/frame/job_options.h"
#include "tools/run/frame/trace_header.h"
#include "tools/sampling/frame_sample.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/tiles/tile_table.h"
#include "tools/timeline/timeline.h"

namespace tools {

/// Mode of a run in which every tile of a frame is simulated on one machine.
struct WholeFrames {
  std::optional<kernels::ProgramSpec> reference;  ///< program of the reference run, if any
  std::uint32_t replicates = 1;                   ///< simulations of each frame; all but the first are perturbed
  bool debug_images = false;
};

/// Mode of a run in which slices of a frame are simulated concurrently, each on its own machine (docs/slices.md).
struct SlicedFrames {
  std::uint32_t slices = 1;  ///< slices per frame; kAutoSlices: chosen automatically
};

/// What a run simulates and how. Invalid combinations of options cannot be represented.
struct RunPlan {
  kernels::ProgramSpec program;
  std::variant<WholeFrames, TileSampling, SlicedFrames, FrameSampling> how;

  const WholeFrames* whole_frames() const { return std::get_if<WholeFrames>(&how); }
  const FrameSampling* frame_sampling() const { return std::get_if<FrameSampling>(&how); }
  /// Returns how the tiles of each frame are sampled; null if frames are simulated as a whole.
  const TileSampling* sampling() const {
    if (const FrameSampling* frames = frame_sampling()) return frames->tiles ? &*frames->tiles : nullptr;
    return std::get_if<TileSampling>(&how);
  }
  const SlicedFrames* slice_settings() const { return std::get_if<SlicedFrames>(&how); }
};

/// Returns the run plan that the options of `raywatt run` describe. Throws InputError for options that exclude each
/// other.
RunPlan make_plan(const JobOptions& options);

/// Results of a run: sums over its frames, and the report of each frame.
struct RunResult {
  std::optional<FrameResult> total, reference;
  double squared_error = 0;                 ///< mean squared error of the picture, summed over all frames
  double worst_squared_error = 0;           ///< error of the picture of the worst frame
  std::optional<double> worst_change = {};  ///< largest PictureError::change of a frame; none without a second frame
  PerceivedError perceived = {};            ///< means over the frames
  sim::Json frames = sim::Json::array();
  IntervalPacker intervals;
  sim::Json reference_frames = sim::Json::array();
  bool partial = false;
  std::string missing;  ///< what an interrupt left out, for a message: "its replicates"
  /// Costs of each tile, rendered with the program and with the reference program. Only for frames simulated with
  /// RunOptions::itemised.
  TileTable tiles, reference_tiles;

  /// Adds the result of a frame and of its reference frame, if any. `error`: error of the frame's picture.
  void add(std::uint32_t number, FrameResult frame, std::optional<FrameResult> compared, const PictureError& error,
           const sim::Intervals* over_time = nullptr);
  ComparedResult report_totals() const;
  /// Marks the run as partial if an interrupt has left this frame with fewer than `replicates` simulations or without
  /// its reference.
  void set_missing_parts(const FrameResult& frame, std::uint32_t replicates, bool lacks_reference);
  /// Returns a text on how much of a run of `all` frames was finished before an interrupt.
  std::string finished_part_text(std::size_t all) const;
};

/// Returns the width with which a run's pictures are compared; 0 without a denoiser, as perceived errors then stay out
/// of the report.
std::uint32_t perceived_width(const RunConfig& config);
/// Returns the errors of a frame that a trace contains.
RecordedError recorded_error(const PictureError& error);

/// Returns how many frames an interrupted run must have finished to replace an earlier result. If that is partial: as
/// many as it has. If it is complete: one more than it has. If there is none: 1. `file`: report.json or verify.json.
std::size_t min_frames_to_replace(const std::filesystem::path& file);

/// Prints the `warnings` of a report to stderr. Skips the first `already_printed` warnings, because they were printed
/// before.
void print_warnings(const sim::Json& report, std::size_t already_printed);

/// Writes report.json, report.txt, config.yaml and, if present, intervals and tiles.json to a folder.
void write_report(const std::filesystem::path& folder, const sim::Json& json, const RunConfig& config,
                  const RunResult& result);

/// Inputs and options of a run, as the origin of its report.
struct Origin {
  const Inputs& inputs;
  const JobOptions& options;
};

/// Writes report and tiles of the reference program into the run's folder, if there is a reference.
void write_reference(const std::filesystem::path& folder, const Origin& origin, const RunResult& result);

/// Prints where the reference's report is, and the command that compares the run with its reference.
void print_reference_location(const std::filesystem::path& folder);

/// Source of the frames of a run: rendered from a scene, read from a trace, or joined from slices. Frames are visited
/// in ascending order.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Returns the configuration and scene of the current frame.
  virtual const Inputs& inputs() const = 0;
  virtual std::uint32_t frame_count() const { return inputs().frames(); }
  /// True if each frame is simulated as a whole on one machine.
  virtual bool has_whole_frames() const { return true; }
  /// Returns the number of slices into which each frame is split; slices are simulated concurrently. 1 if frames are
  /// not split.
  virtual std::uint32_t slices() const { return 1; }
  virtual bool has_reference() const = 0;
  /// Returns the number of simulations of each frame; all but the first are perturbed (docs/noise.md).
  virtual std::uint32_t replicates() const { return 1; }
  /// Simulates the current frame with the run's program; simulate_reference() does so with the reference program.
  virtual FrameResult simulate(const SimulateOptions& extras) = 0;
  virtual FrameResult simulate_reference(const SimulateOptions& extras) = 0;
  /// Returns the error of the current frame's picture. Called once per frame, in the order of the frames.
  virtual PictureError compare_pictures(const FrameResult& frame, const FrameResult& reference) = 0;
  /// Advances to the next frame; false after the last.
  virtual bool advance_frame() = 0;
  /// Completes the result of a run after its last frame.
  virtual void complete_result(RunResult&) const {}
};

/// Frame source for a scene. advance_frame() poses the scene in `inputs` for the next frame.
class PosedFrames : public FrameSource {
 public:
  PosedFrames(Inputs& inputs, std::uint32_t threads, Progress* progress)
      : inputs_(inputs), threads_(threads), progress_(progress) {}
  const Inputs& inputs() const override { return inputs_; }
  bool advance_frame() override { return tools::advance_frame(inputs_, threads_, progress_); }

 protected:
  Inputs& inputs_;
  const std::uint32_t threads_;
  Progress* const progress_;
};

/// Frames rendered from the scene. Host threads render tiles ahead of the simulated machine.
class RenderedFrames final : public PosedFrames {
 public:
  /// Throws InputError if the frames cannot be split into the plan's slices.
  RenderedFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress);
  std::uint32_t slices() const override { return std::max(1U, slices_); }
  bool has_whole_frames() const override;
  bool has_reference() const override { return plan_.whole_frames() != nullptr && plan_.whole_frames()->reference; }
  std::uint32_t replicates() const override {
    return plan_.whole_frames() != nullptr ? plan_.whole_frames()->replicates : 1;
  }
  FrameResult simulate(const SimulateOptions& extras) override;
  FrameResult simulate_reference(const SimulateOptions& extras) override;
  PictureError compare_pictures(const FrameResult& frame, const FrameResult& reference) override;

 private:
  const RunPlan plan_;
  std::uint32_t slices_ = 0;  ///< slices per frame; 0 if frames are not split
  kernels::RateMap rates_, reference_rates_;
  std::shared_ptr<const kernels::DenoiseHistory> history_;
  PictureComparison pictures_;
  std::shared_ptr<const hw::CacheContents> caches_, reference_caches_;  ///< contents of the caches after the last frame
};

/// Returns the frames of a run rendered from the scene: all frames, or representative ones. Throws InputError, and
/// Interrupted.
std::unique_ptr<FrameSource> make_frames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads,
                                         Progress* progress);

/// A finished frame, before it is added to the run's result.
struct SimulatedFrame {
  const Inputs& inputs;
  const FrameResult& frame;
  const FrameResult* reference = nullptr;
  const TileFrame* tiles = nullptr;  ///< costs of each tile, if costs are itemised
  bool is_first = true;
};

/// Options of run(): observers, recorded data, and which results are kept after an interrupt.
struct RunOptions {
  Progress* progress = nullptr;
  bool keep_part = false;  ///< an interrupt keeps the finished tiles of the first frame
  bool intervals = false;  ///< record counters over time
  bool itemised = false;   ///< keep the costs of each tile and pixel
  /// Observer of the machines of whole frames, and the function that receives each of these frames before its first
  /// cycle. If the function is set, the machine records intervals for it.
  hw::Observer* observer = nullptr;
  std::function<void(const StartedFrame&)> on_start = {};
  TimelineJob* timeline = nullptr;       ///< records a timeline of the first frame; null: none
  traces::TraceWriter* trace = nullptr;  ///< trace file that receives the executed work; null: none
  std::function<void(const SimulatedFrame&)> on_frame = {};
};

/// Simulates all frames of a source. After an interrupt the result is marked partial and contains the finished frames,
/// or with `keep_part` the finished tiles of the first frame. Throws Interrupted if no frame or tile is finished.
RunResult run(FrameSource& frames, const RunOptions& options);

/// Simulates all frames of `inputs` and returns their report as JSON; writes no pictures. It uses only the program,
/// reference, replicates and threads of `options`. Throws Interrupted after an interrupt.
sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress = nullptr);
}  // namespace tools
