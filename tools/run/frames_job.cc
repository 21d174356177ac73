#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/analysis/report.h"
#include "tools/host/interrupt.h"
#include "tools/host/run_folder.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/host_time.h"
#include "tools/run/frame/trace_header.h"
#include "tools/run/jobs.h"
#include "tools/run/live_run.h"
#include "tools/run/picture_files.h"
#include "tools/run/run.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// Calls run(); throws Interrupted if an interrupt leaves fewer than `frames_to_replace` frames.
RunResult run_or_interrupt(FrameSource& frames, const RunOptions& options, std::size_t frames_to_replace,
                           Progress& progress) {
  const HoldInterrupts hold;  // results exist before the folder does
  try {
    RunResult result = run(frames, options);
    if (result.partial && result.frames.size() < frames_to_replace) throw Interrupted();
    return result;
  } catch (const Interrupted&) {
    progress.finish("interrupted");
    throw;
  }
}

/// Returns the absolute path of --record. InputError if it would replace one of the run's own results.
std::filesystem::path record_file(const JobOptions& options, const std::filesystem::path& folder) {
  const std::string asked = "--record " + sim::printable(options.record.string());
  std::error_code failed;
  std::filesystem::path file = std::filesystem::absolute(options.record, failed);
  if (!failed) file = std::filesystem::weakly_canonical(file, failed);
  if (failed) throw sim::InputError(fmt::format("{}: cannot be written ({})", asked, failed.message()));
  if (std::ranges::mismatch(file, folder).in1 == file.end())
    throw sim::InputError(asked + ": the run's folder goes there or below; allowed: another name");
  if (file.parent_path() != folder || !is_result_name(file.filename().string())) return file;
  throw sim::InputError(asked + ": the run's own results have a file of this name; allowed: another");
}

/// Results to list on standard output.
struct Announced {
  bool picture, timeline, reference;
};
void print_results(const sim::Json& json, const std::filesystem::path& folder, const Announced& has) {
  fmt::print("{}\n", terminal_text(report_table(json)));
  if (has.picture) fmt::print("picture: {}\n", (folder / "image.png").string());
  if (has.timeline) fmt::print("timeline: {}\n", (folder / kTimelineFile).string());
  fmt::print("report:  {}\n", (folder / "report.json").string());
  if (has.reference) print_reference_location(folder);
  fmt::print("page:    raywatt report {0} -o {1}\n", command_text({folder.string()}),
             command_text({folder.string() + ".html"}));
}

}  // namespace

void run_frames(const JobOptions& options) {
  const auto begin = sim::HostClock::now();
  const RunPlan plan = make_plan(options);
  TimelineJob timeline(options.timeline);
  RunFolder folder(options.out, options.force);
  LiveRun live;
  Progress progress(options.watch ? "watch" : options.progress, options.quiet, &live);
  Inputs inputs = load_inputs(options, &progress);
  RenderedFrames frames(inputs, plan, options.threads, &progress);
  live.set_config(inputs.config);
  timeline.check_selection(inputs, plan.program);
  print_warnings(inputs.warnings, &progress);
  if (plan.sampling() == nullptr && progress.shows_hints()) {
    const RunParallelism plays{options.threads, frames.replicates(), frames.slices()};
    double frame = estimate_seconds(inputs, plan.program, plays);
    if (frames.has_reference()) frame += estimate_seconds(inputs, *plan.whole_frames()->reference, plays);
    print_duration_hint(inputs.load_seconds + frame * inputs.frames(),
                        "a smaller --resolution, fewer --frames or --tile-sampling take less", progress);
  }
  progress.expect_parts(inputs.frames() * (frames.has_reference() ? 2 : 1) * frames.replicates());
  const std::size_t to_replace = frames_to_replace(folder.target() / "report.json");
  const bool has_picture = plan.sampling() == nullptr || plan.sampling()->full_image;

  sim::Json json;
  folder.fill([&](const RunFolder::Open& open) {
    std::optional<traces::TraceWriter> trace;
    if (!options.record.empty()) {
      // If the folder does not exist yet, the trace is staged with the report.
      const std::filesystem::path file = record_file(options, folder.target());
      const bool comes_along = file.parent_path() == folder.target() && !std::filesystem::exists(folder.target());
      trace.emplace(comes_along ? open() / file.filename() : std::filesystem::path(options.record),
                    trace_header(inputs, options));
    }
    const auto write_frame = [&](const PlayedFrame& played) {
      progress.set_phase("writing the picture");
      write_pictures(
          open(),
          {.played = played, .program = plan.program, .has_picture = has_picture, .debug = options.debug_images},
          host_threads(options.threads));
    };
    const RunResult result = run_or_interrupt(frames,
                                              {.progress = &progress,
                                               .keep_part = !folder.holds_former_run(),
                                               .intervals = options.intervals,
                                               .itemised = true,
                                               .live = options.watch ? &live : nullptr,
                                               .timeline = &timeline,
                                               .trace = trace ? &*trace : nullptr,
                                               .on_frame = write_frame},
                                              to_replace, progress);
    progress.finish(result.partial ? "interrupted" : "done");
    const std::filesystem::path& staging = open();
    const double wall = sim::seconds_since(begin);
    json = report_json({inputs, options, result.report_totals(), result.frames, result.partial, wall});
    timeline.write_file(staging, json);
    write_report(staging, json, inputs.config, result);
    write_reference(staging, {inputs, options}, result);
    if (trace && !result.partial) trace->commit();
    print_warnings(json, inputs.warnings.size());  // before a pending interrupt ends the process
    return result.kept_text(inputs.frames());
  });
  if (options.json) return fmt::print("{}", sim::json_text(json["totals"]));
  if (options.quiet) return;
  print_results(json, folder.target(), {has_picture, timeline.tile_selection().has_value(), frames.has_reference()});
}

}  // namespace tools
