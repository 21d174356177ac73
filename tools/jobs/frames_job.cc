#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/report.h"
#include "tools/host/command_text.h"
#include "tools/host/interrupt.h"
#include "tools/host/run_folder.h"
#include "tools/host/standard_streams.h"
#include "tools/jobs/jobs.h"
#include "tools/jobs/live_run.h"
#include "tools/jobs/outcome.h"
#include "tools/jobs/picture_files.h"
#include "tools/sampling/slices.h"
#include "tools/sampling/tile_sampling.h"
#include "tools/simulation/host_time.h"
#include "tools/simulation/recorded.h"
#include "tools/simulation/run_job.h"
#include "tools/tiles/tile_frame.h"
#include "tools/timeline/timeline_job.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {
namespace {

/// A frame program and what it carries from frame to frame.
struct Program {
  kernels::ProgramSpec spec;
  kernels::RateMap rates;
};

struct Job {
  const JobOptions& options;
  Progress& progress;
  Program program;
  std::optional<Program> reference;
  bool keep_part = false;             ///< keeps that of the first frame, if the run comes no further
  std::size_t frames_to_replace = 1;  ///< fewer are not kept if the run is interrupted
  std::optional<TileSampling> sampling;
  std::optional<std::uint32_t> slices;
  traces::TraceWriter* trace = nullptr;
  LiveRun* live = nullptr;
  TimelineJob timeline = TimelineJob(options.timeline);
  /// The frame is played on one machine from its first tile to its last.
  bool is_whole() const { return !sampling && slices.value_or(1) == 1; }
  bool has_picture() const { return !sampling || sampling->full_image; }

  Simulation simulate_frame(const Inputs& inputs, bool may_be_part, sim::Intervals* intervals) {
    if (sampling) return simulate_sampled(inputs, program.spec, options.threads, *sampling, &progress);
    if (slices && *slices > 1) return simulate_slices(inputs, program.spec, options.threads, *slices, &progress);
    return simulate(inputs, program.spec, options.threads,
                    {.rates = &program.rates,
                     .marks = options.debug_images,
                     .keep_part = may_be_part,
                     .progress = &progress,
                     .trace = trace,
                     .intervals = intervals,
                     .watcher = live,
                     .replicates = options.replicates,
                     .itemised = true,
                     .watchers = timeline.begin_frame(inputs.config)});
  }

  /// Simulates the frame that `inputs` stand at and writes its picture. An interrupt leaves the finished part of the
  /// first frame, not compared.
  void run_frame(const Inputs& inputs, const RunFolder::Open& open, Outcome& out) {
    const bool may_be_part = keep_part && out.frames.empty() && is_whole();
    std::optional<sim::Intervals> intervals;
    if ((options.intervals || live != nullptr) && is_whole()) intervals = intervals_of_frame(inputs.frames());
    Simulation frame = simulate_frame(inputs, may_be_part, intervals ? &*intervals : nullptr);
    if (slices && !frame.sliced) frame.sliced = uncut(frame);
    if (!frame.tile_accounts.empty()) {
      out.tiles.frames.push_back(tile_frame(frame, inputs.config, inputs.frame));
      timeline.end_frame(frame, out.tiles.frames.back(), inputs.config);
    }
    std::optional<Simulation> compared;
    if (reference && !frame.is_part()) {
      try {
        compared = simulate(inputs, reference->spec, options.threads,
                            {.rates = &reference->rates,
                             .progress = &progress,
                             .trace = trace,
                             .reference = true,
                             .replicates = options.replicates});
      } catch (const Interrupted&) {
        if (!may_be_part) throw;
      }
    }
    const bool lacks_replicates = frame.replicates.size() + 1 < options.replicates;
    out.partial = frame.is_part() || lacks_replicates || (reference && !compared);
    const double error = compared ? mean_squared_error(frame.function.rgb, compared->function.rgb) : 0;
    if (trace != nullptr && !out.partial) trace->end_frame(recorded_frame(inputs.frame, error));
    progress.phase("writing the picture");
    write_pictures(open(),
                   {.inputs = inputs,
                    .program = program.spec,
                    .frame = frame,
                    .compared = compared ? &*compared : nullptr,
                    .tiles = out.tiles.frames.empty() ? nullptr : &out.tiles.frames.back(),
                    .is_first = out.frames.empty(),
                    .has_picture = has_picture(),
                    .debug = options.debug_images},
                   host_threads(options.threads));
    out.add(inputs.frame, std::move(frame), std::move(compared), error,
            options.intervals && intervals ? &*intervals : nullptr);
  }

  /// All frames, or what an interrupt has left time for; Interrupted if that is nothing.
  Outcome run_all(Inputs& inputs, const RunFolder::Open& folder) {
    const HoldInterrupts hold;  // there is something to lose before there is a folder
    Outcome out;
    try {
      run_frame(inputs, folder, out);
      while (!out.partial && inputs.frame < inputs.config.scene.last_frame) {
        advance(inputs, inputs.frame + 1, options.threads, &progress);
        run_frame(inputs, folder, out);
      }
    } catch (const Interrupted&) {
      out.partial = true;
    }
    if (out.partial && out.frames.size() < frames_to_replace) {
      progress.end("interrupted");
      throw Interrupted();
    }
    return out;
  }
};

/// How frames are sampled, if they are; InputError for what does not go with it.
std::optional<TileSampling> sampling_of(const JobOptions& options, const kernels::ProgramSpec& program) {
  if (options.tile_sampling.empty()) {
    if (options.image != "full") throw sim::InputError("--image none goes with --tile-sampling only");
    return std::nullopt;
  }
  check_tile_sampling(program);
  const auto refuse = [](const char* option, const char* why) {
    throw sim::InputError(fmt::format("--tile-sampling does not go with {}: {}", option, why));
  };
  if (!options.reference.empty()) refuse("--reference", "compare two runs of all tiles");
  if (options.replicates > 1) refuse("--replicates", "replicates play all tiles");
  if (!options.timeline.empty()) refuse("--timeline", "a timeline is of a frame whose tiles are all timed");
  if (!options.record.empty()) refuse("--record", "a trace has all tiles");
  if (options.debug_images) refuse("--debug-images", "they show what all tiles took");
  return parse_tile_sampling(options.tile_sampling, options.image);
}

/// Slices that are asked for, if they are; InputError for what does not go with them.
std::optional<std::uint32_t> asked_slices(const JobOptions& options, const kernels::ProgramSpec& program) {
  if (options.slices.empty()) return std::nullopt;
  const std::uint32_t asked = parse_slices(options.slices);
  check_slices(program);
  const auto refuse = [](const char* option, const char* why) {
    throw sim::InputError(fmt::format("--slices does not go with {}: {}", option, why));
  };
  if (!options.tile_sampling.empty()) refuse("--tile-sampling", "a sample of the tiles is not cut");
  if (!options.reference.empty()) refuse("--reference", "compare two runs with equal --slices");
  if (options.replicates > 1) refuse("--replicates", "replicates are played side by side already");
  if (!options.timeline.empty()) refuse("--timeline", "a timeline is of one machine");
  if (!options.record.empty()) refuse("--record", "slices render tiles at their borders twice");
  if (options.debug_images) refuse("--debug-images", "what a tile took is that of one machine");
  return asked;
}

/// The file of --record, which does not take the place of one of the run's own results in `folder`.
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

void tell_results(const Job& job, const sim::Json& json, const std::filesystem::path& folder) {
  fmt::print("{}\n", for_terminal(report_table(json)));
  if (job.has_picture()) fmt::print("picture: {}\n", (folder / "image.png").string());
  if (job.timeline.selection()) fmt::print("timeline: {}\n", (folder / kTimelineFile).string());
  fmt::print("report:  {}\n", (folder / "report.json").string());
  if (job.reference) tell_reference(folder);
  fmt::print("page:    raywatt report {0} -o {1}\n", command_text({folder.string()}),
             command_text({folder.string() + ".html"}));
}

}  // namespace

void run_frames(const JobOptions& options) {
  const auto begin = sim::HostClock::now();
  const kernels::ProgramSpec program = kernels::parse_program(options.program);
  std::optional<kernels::ProgramSpec> reference;
  if (!options.reference.empty()) reference = kernels::parse_program(options.reference);
  const std::optional<TileSampling> sampling = sampling_of(options, program);
  const std::optional<std::uint32_t> slices = asked_slices(options, program);
  RunFolder folder(options.out, options.force);
  LiveRun live;
  Progress progress(options.watch ? "watch" : options.progress, options.quiet, &live);
  Inputs inputs = load_inputs(options, &progress);
  const kernels::RateMap rates(inputs.config.programs.multirate);
  Job job{options,
          progress,
          {program, rates},
          {},
          !folder.holds_former_run(),
          frames_to_replace(folder.target() / "report.json"),
          sampling,
          slices,
          nullptr,
          options.watch ? &live : nullptr};
  if (slices) job.slices = slices_of(inputs.config, program, *slices);
  live.of(inputs.config);
  if (reference) job.reference = Program{*reference, rates};
  job.timeline.check(inputs, program);
  tell_warnings(inputs.warnings, &progress);
  if (!sampling) {
    tell_long(estimated_host_seconds(inputs, program) * inputs.frames(),
              "a smaller --resolution, fewer --frames or --tile-sampling take less", progress);
  }
  progress.expect(inputs.frames() * (reference ? 2 : 1) * options.replicates);

  sim::Json json;
  folder.fill([&](const RunFolder::Open& open) {
    std::optional<traces::TraceWriter> trace;
    if (!options.record.empty()) {
      // Into a folder that is not there yet it comes with the report.
      const std::filesystem::path file = record_file(options, folder.target());
      const bool comes_along = file.parent_path() == folder.target() && !std::filesystem::exists(folder.target());
      job.trace = &trace.emplace(comes_along ? open() / file.filename() : std::filesystem::path(options.record),
                                 trace_header(inputs, options));
    }
    const Outcome out = job.run_all(inputs, open);
    progress.end(out.partial ? "interrupted" : "done");
    const std::filesystem::path& staging = open();
    const double wall = sim::seconds_since(begin);
    const Result result = out.result();
    json = report_json({inputs, options, result, out.frames, out.partial, wall});
    job.timeline.write(staging, json);
    write_report(staging, json, inputs.config, out);
    write_reference(staging, {inputs, options}, out);
    if (trace && !out.partial) trace->commit();
    tell_warnings(json, inputs.warnings.size());  // before an interrupt ends the run, which throws
    return out.kept(inputs.frames());
  });
  if (options.json) return fmt::print("{}", sim::json_text(json["totals"]));
  if (options.quiet) return;
  tell_results(job, json, folder.target());
}

}  // namespace tools
