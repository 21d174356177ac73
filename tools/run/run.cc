#include "tools/run/run.h"

#include <utility>

#include "sim/io/json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/host/interrupt.h"
#include "tools/run/frame/recorded.h"
#include "tools/sampling/slices.h"
#include "tools/tiles/tile_frame.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

RenderedFrames::RenderedFrames(Inputs& inputs, const RunPlan& plan, std::uint32_t threads, Progress* progress)
    : PosedFrames(inputs, threads, progress),
      plan_(plan),
      slices_(plan.sliced() != nullptr ? slices_of(inputs.config, plan.program, plan.sliced()->slices) : 0),
      rates_(inputs.config.programs.multirate),
      reference_rates_(rates_) {}

bool RenderedFrames::has_whole_frames() const { return plan_.sampling() == nullptr && slices_ <= 1; }

FrameResult RenderedFrames::play(const SimulateOptions& extras) {
  if (plan_.sampling() != nullptr)
    return simulate_sampled(inputs_, plan_.program, threads_, *plan_.sampling(), progress_);
  if (slices_ > 1) return simulate_slices(inputs_, plan_.program, threads_, slices_, progress_);
  SimulateOptions own = extras;
  own.rates = &rates_;
  own.marks = plan_.whole() != nullptr && plan_.whole()->debug_images;
  FrameResult frame = simulate(inputs_, plan_.program, threads_, own);
  if (slices_ == 1) frame.sliced = uncut(frame);
  return frame;
}

FrameResult RenderedFrames::play_reference(const SimulateOptions& extras) {
  SimulateOptions own = extras;
  own.rates = &reference_rates_;
  own.reference = true;
  return simulate(inputs_, *plan_.whole()->reference, threads_, own);
}

double RenderedFrames::squared_error(const FrameResult& frame, const FrameResult& reference) const {
  return mean_squared_error(frame.function.rgb, reference.function.rgb);
}

namespace {

/// Simulates the current frame and its reference, and adds them to `out`.
void play_frame(FrameSource& frames, const RunOptions& options, RunResult& out) {
  const Inputs& inputs = frames.inputs();
  const bool may_be_part = options.keep_part && out.frames.empty() && frames.has_whole_frames();
  std::optional<sim::Intervals> intervals;
  if ((options.intervals || options.live != nullptr) && frames.has_whole_frames()) {
    intervals = intervals_of_frame(frames.count());
  }
  const SimulateOptions common{.progress = options.progress, .trace = options.trace, .replicates = frames.replicates()};
  SimulateOptions own = common;
  own.keep_part = may_be_part;
  own.intervals = intervals ? &*intervals : nullptr;
  own.watcher = options.live;
  own.itemised = options.itemised;
  if (options.timeline != nullptr && frames.has_whole_frames())
    own.observer = options.timeline->begin_frame(inputs.config);
  FrameResult frame = frames.play(own);
  const bool has_tiles = !frame.tile_accounts.empty();
  if (has_tiles) {
    out.tiles.frames.push_back(tile_frame(frame, inputs.config, inputs.frame));
    if (options.timeline != nullptr) options.timeline->end_frame(frame, out.tiles.frames.back(), inputs.config);
  }
  std::optional<FrameResult> reference;
  if (frames.has_reference() && !frame.is_part()) {
    try {
      reference = frames.play_reference(common);
    } catch (const Interrupted&) {
      if (!may_be_part) throw;
    }
  }
  out.set_partial(frame, frames.replicates(), frames.has_reference() && !reference);
  const double error = reference ? frames.squared_error(frame, *reference) : 0;
  if (options.trace != nullptr && !out.partial) options.trace->end_frame(recorded_frame(inputs.frame, error));
  if (options.on_frame) {
    options.on_frame({.inputs = inputs,
                      .frame = frame,
                      .reference = reference ? &*reference : nullptr,
                      .tiles = has_tiles ? &out.tiles.frames.back() : nullptr,
                      .is_first = out.frames.empty()});
  }
  out.add(inputs.frame, std::move(frame), std::move(reference), error,
          options.intervals && intervals ? &*intervals : nullptr);
}

}  // namespace

RunResult run(FrameSource& frames, const RunOptions& options) {
  RunResult out;
  try {
    do {
      play_frame(frames, options, out);
    } while (!out.partial && frames.advance());
  } catch (const Interrupted&) {
    if (out.frames.empty()) throw;
    out.partial = true;
  }
  return out;
}

sim::Json plain_report(Inputs inputs, const JobOptions& options, Progress* progress) {
  RenderedFrames frames(inputs, make_plan(options), options.threads, progress);
  const RunResult result = run(frames, {.progress = progress});
  if (result.partial) throw Interrupted();
  return report_json({inputs, options, result.totals(), result.frames, false, 0});
}

}  // namespace tools
