#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hw_models/machines/gpu_config.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "tools/analysis/info.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/host/process.h"
#include "tools/host/run_folder.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/host_time.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/jobs.h"
#include "tools/run/stored_frames.h"
#include "tools/timeline/timeline.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/trace_reader.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// Renders frames with a frame program and its tile rates, and records their work without simulating a machine.
struct Recorder {
  kernels::ProgramSpec spec;
  kernels::RateMap rates;
  std::shared_ptr<const kernels::DenoiseHistory> history = nullptr;

  std::vector<float> record_frame(const Inputs& inputs, std::uint32_t threads, Progress& progress,
                                  traces::TraceWriter& trace, bool reference) {
    const traces::BvhTracer tracer(inputs.image, inputs.config.gpu->tni.predictor);
    return render_frame(
               inputs, spec, tracer, threads,
               {.rates = &rates, .history = &history, .progress = &progress, .trace = &trace, .reference = reference})
        .rgb;
  }
};

/// Removes counts of adaptive sampling from the report of a partial frame, because a trace has them only for whole
/// frames.
void remove_sampling_counts(sim::Json& report) {
  for (sim::Json* totals : {&report["totals"], &report["frames"].front()}) {
    totals->erase("traced_ratio");
    (*totals)["rays"].erase("continued");
    (*totals)["sampling"] = sim::Json::object();
  }
}

}  // namespace

void record_trace(const JobOptions& options, const std::filesystem::path& file) {
  const kernels::ProgramSpec spec = kernels::parse_program(options.program);
  std::optional<kernels::ProgramSpec> compared;
  if (!options.reference.empty()) compared = kernels::parse_program(options.reference);
  Progress progress(options.progress, options.quiet);
  Inputs inputs = load_inputs(options, &progress);
  refuse_sorting(inputs.config, "trace record");
  print_warnings(inputs.warnings, &progress);
  if (progress.shows_hints()) {
    double frame = estimate_render_seconds(inputs, spec, 1, options.threads);
    if (compared) frame += estimate_render_seconds(inputs, *compared, 1, options.threads);
    print_duration_hint(inputs.load_seconds + frame * inputs.frames(),
                        "a smaller --resolution or fewer --frames take less", progress);
  }
  progress.expect_parts(inputs.frames() * (compared ? 2 : 1));
  const kernels::RateMap rates(inputs.config.programs.multirate);
  Recorder program{spec, rates};
  std::optional<Recorder> reference;
  if (compared) reference = Recorder{*compared, rates};

  auto opened = std::make_unique<traces::TraceWriter>(file, trace_header(inputs, options));
  const HoldInterrupts hold;  // before the first tile; `trace` is destroyed first and removes a half-written file
  const std::unique_ptr<traces::TraceWriter> trace = std::move(opened);
  PictureComparison pictures;
  for_each_frame(inputs, options.threads, &progress, [&] {
    const std::vector<float> picture = program.record_frame(inputs, options.threads, progress, *trace, false);
    PictureError error;
    if (reference) {
      error = pictures.compare_frame(picture, reference->record_frame(inputs, options.threads, progress, *trace, true),
                                     perceived_width(inputs.config));
    }
    trace->end_frame(recorded_frame(inputs.frame, recorded_error(error)));
  });
  trace->commit();
  progress.finish("done");
  if (!options.quiet) fmt::print("{}", trace_info_text(trace_info(traces::TraceReader(file))));
}

void replay_trace(const JobOptions& options, const std::filesystem::path& file) {
  const auto begin = sim::HostClock::now();
  RunFolder folder(options.out, options.force, kResultsOfReplay);
  std::optional<HoldInterrupts> hold;  // its destructor ends the process after the last progress line
  Progress progress(options.progress, options.quiet);
  TimelineJob timeline(options.timeline);
  if (timeline.tile_selection() && timeline.tile_selection()->needs_tile_positions()) {
    throw sim::InputError("--timeline: a trace does not know where tiles lie in the picture; allowed: all, slowest:N");
  }
  StoredFrames frames(file, options);
  print_warnings(frames.inputs().warnings, &progress);
  if (progress.shows_hints()) print_duration_hint(frames.estimate_seconds(), {}, progress);
  progress.expect_parts(frames.frame_count() * (frames.has_reference() ? 2 : 1));
  const std::size_t to_replace = min_frames_to_replace(folder.target() / "report.json");
  hold.emplace();
  sim::Json json;
  folder.fill([&](const RunFolder::Open& open) {
    const RunResult result = run(frames, {.progress = &progress,
                                          .keep_part = !folder.has_earlier_run(),
                                          .intervals = options.intervals,
                                          .itemised = true,
                                          .timeline = &timeline});
    progress.finish(result.partial ? "interrupted" : "done");
    if (result.partial && result.frames.size() < to_replace) throw Interrupted();
    const double wall = sim::seconds_since(begin);
    json = report_json({frames.inputs(), options, result.report_totals(), result.frames, result.partial, wall});
    if (result.total->is_partial()) remove_sampling_counts(json);
    timeline.write_file(open(), json);
    write_report(open(), json, frames.inputs().config, result);
    write_reference(open(), {frames.inputs(), options}, result);
    print_warnings(json, frames.inputs().warnings.size());  // before a pending interrupt ends the process
    return result.finished_part_text(frames.frame_count());
  });
  hold.reset();
  if (options.quiet) return;
  fmt::print("{}\nreport:  {}\n", to_terminal_encoding(report_table(json)), (folder.target() / "report.json").string());
  if (timeline.tile_selection()) fmt::print("timeline: {}\n", (folder.target() / kTimelineFile).string());
  if (json["totals"].contains("reference")) print_reference_location(folder.target());
}

}  // namespace tools
