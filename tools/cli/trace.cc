#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/analysis/picture.h"
#include "tools/analysis/trace_info.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/interrupt.h"
#include "tools/host/run_folder.h"
#include "tools/jobs/replay.h"
#include "tools/simulation/recorded.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/trace_file/trace_writer.h"

namespace tools {

namespace {

/// "[CONFIG] FILE"
struct Arguments {
  std::vector<std::string> words;
  const std::string& file() const { return words.back(); }
  bool has_config() const { return words.size() == 2; }
};

/// What is rendered, without a machine: a frame program and what it carries from frame to frame.
struct Recorder {
  kernels::ProgramSpec spec;
  kernels::RateMap rates;

  std::vector<float> record(const Inputs& inputs, std::uint32_t threads, Progress& progress, traces::TraceWriter& trace,
                            bool reference) {
    const traces::BvhTracer tracer(inputs.image);
    return render(inputs, spec, tracer, threads,
                  {.rates = &rates, .progress = &progress, .trace = &trace, .reference = reference})
        .rgb;
  }
};

void record(JobOptions options, const Arguments& arguments) {
  if (arguments.has_config()) options.config = arguments.words.front();
  const kernels::ProgramSpec spec = kernels::parse_program(options.program);
  std::optional<kernels::ProgramSpec> compared;
  if (!options.reference.empty()) compared = kernels::parse_program(options.reference);
  Progress progress(options.progress, options.quiet);
  Inputs inputs = load_inputs(options, &progress);
  for (const std::string& warning : inputs.warnings) progress.say("raywatt: warning: " + warning);
  progress.expect(inputs.frames() * (compared ? 2 : 1));
  const kernels::RateMap rates(inputs.config.programs.multirate);
  Recorder program{spec, rates};
  std::optional<Recorder> reference;
  if (compared) reference = Recorder{*compared, rates};

  auto opened = std::make_unique<traces::TraceWriter>(arguments.file(), trace_header(inputs, options));
  const HoldInterrupts hold;  // from the first tile on; what is half written is removed before it is let go
  const std::unique_ptr<traces::TraceWriter> trace = std::move(opened);
  for (;;) {
    const std::vector<float> picture = program.record(inputs, options.threads, progress, *trace, false);
    double error = 0;
    if (reference) {
      error = mean_squared_error(picture, reference->record(inputs, options.threads, progress, *trace, true));
    }
    trace->end_frame(recorded_frame(inputs.frame, error));
    if (inputs.frame == inputs.config.scene.last_frame) break;
    advance(inputs, inputs.frame + 1, options.threads, &progress);
  }
  trace->commit();
  progress.end("done");
  if (!options.quiet) fmt::print("{}", trace_info_text(trace_info(traces::TraceReader(arguments.file()))));
}

/// A trace says of whole frames only what was sampled, and how many rays went on.
void leave_out_sampling(nlohmann::ordered_json& report) {
  for (nlohmann::ordered_json* figures : {&report["totals"], &report["frames"].front()}) {
    figures->erase("traced_ratio");
    (*figures)["rays"].erase("continued");
    (*figures)["sampling"] = nlohmann::ordered_json::object();
  }
}

void replay(JobOptions options, const Arguments& arguments) {
  const auto begin = sim::HostClock::now();
  options.config = arguments.has_config() ? arguments.words.front() : "";
  RunFolder folder(options.out, options.force, kResultsOfReplay);
  std::optional<HoldInterrupts> hold;  // ends the process after the progress has told its last
  Progress progress(options.progress, options.quiet);
  Replay job(arguments.file(), options);
  progress.expect(job.parts());
  hold.emplace();
  nlohmann::ordered_json json;
  folder.fill([&](const RunFolder::Open& open) {
    const Outcome out = job.run(options.threads, &progress, !folder.holds_former_run());
    progress.end(out.partial ? "interrupted" : "done");
    const double wall = sim::seconds_since(begin);
    const Result result = out.result();
    json = report_json({job.inputs(), options, result, out.frames, out.partial, wall});
    if (out.total->is_part()) leave_out_sampling(json);
    write_report(open(), json, job.inputs().config);
    return out.kept(job.frames());
  });
  hold.reset();
  if (options.quiet) return;
  fmt::print("{}\nreport:  {}\n", report_table(json), (folder.target() / "report.json").string());
}

void add_arguments(CLI::App& verb, Arguments& arguments) {
  verb.add_option("arguments", arguments.words, "[CONFIG] FILE: a configuration, if any, and the trace")
      ->required()
      ->expected(1, 2)
      ->type_name("");
}

void add_record(CLI::App& group, const std::vector<std::string>& argv) {
  CLI::App* verb = group.add_subcommand("record", "Write the work of a run into a file; no machine is simulated");
  const auto options = std::make_shared<JobOptions>();
  const auto arguments = std::make_shared<Arguments>();
  options->argv = argv;
  add_arguments(*verb, *arguments);
  add_work_options(*verb, *options, false);
  add_frames_option(*verb, *options);
  add_reference_option(*verb, *options);
  verb->add_flag("--quiet", options->quiet, "say nothing");
  add_progress_option(*verb, options->progress);
  verb->footer("Example: raywatt trace record --scene chess --resolution 512x256 chess.trace");
  verb->callback([=] { record(*options, *arguments); });
}

void add_replay(CLI::App& group, const std::vector<std::string>& argv) {
  CLI::App* verb = group.add_subcommand(
      "replay", "Play a file on a machine; the report is that of the run it came from, without pictures");
  const auto options = std::make_shared<JobOptions>();
  const auto arguments = std::make_shared<Arguments>();
  options->argv = argv;
  add_arguments(*verb, *arguments);
  add_set_option(*verb, options->sets);
  add_ideal_option(*verb, *options);
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  add_output_options(*verb, *options);
  verb->footer(
      "Without CONFIG: on the machine that it was recorded with. Keys that change the work must be as recorded.\n\n"
      "Example: raywatt trace replay chess.trace --set cores=2 -o out/two-cores");
  verb->callback([=] { replay(*options, *arguments); });
}

void add_info(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("info", "What a file holds");
  const auto file = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("file", *file, "the trace")->required();
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt trace info chess.trace --json");
  verb->callback([=] {
    const nlohmann::ordered_json info = trace_info(traces::TraceReader(*file));
    fmt::print("{}", *json ? sim::json_text(info) : trace_info_text(info));
  });
}

}  // namespace

void add_trace(CLI::App& app, const std::vector<std::string>& argv) {
  CLI::App* verb = app.add_subcommand("trace", "Work on disk: recorded once, played on any machine");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt trace replay chess.trace --set cores=2");
  add_record(*verb, argv);
  add_replay(*verb, argv);
  add_info(*verb);
}

}  // namespace tools
