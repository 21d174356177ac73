#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "tools/analysis/info.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/run/jobs.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {

void add_run_command(CLI::App& app, const std::vector<std::string>& argv, int&) {
  CLI::App* verb = app.add_subcommand("run", "Render on the simulated GPU and report cycles, rays and energy");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_work_options(*verb, *options);
  add_frames_option(*verb, *options);
  add_ideal_option(*verb, *options);
  add_output_options(*verb, *options);
  add_fps_option(*verb, options->sets);
  add_reference_option(*verb, *options);
  verb->add_option("--record", options->record, "also write the work to this trace file, for raywatt trace replay");
  verb->add_flag(
      "--debug-images", options->debug_images,
      "also write pictures of costs (debug-cycles.png, debug-steps.png, debug-energy.png, ...) and of adaptive\n"
      "sampling (debug-similar.png, debug-check-NAME.png, ...)");
  verb->add_option("--tile-sampling", options->tile_sampling,
                   "simulate some of the frame's tiles and estimate the rest, with 95 % intervals: a share of the\n"
                   "frame's work, e.g. 5%, or auto, which adds tiles until the intervals are +-2 % (docs/sampling.md)")
      ->check([](const std::string& text) { return text.empty() ? std::string("is empty; allowed: 5%, auto") : ""; });
  verb->add_option(
          "--representative", options->representative,
          "simulate some of the frames of --frames and estimate the totals of all, with 95 % intervals: auto,\n"
          "which adds frames until the intervals are +-3 %, or a number of clusters of similar frames, e.g. 12\n"
          "(docs/sequences.md)")
      ->check([](const std::string& text) { return text.empty() ? std::string("is empty; allowed: auto, 12") : ""; });
  verb->add_option(
          "--image", options->image,
          "with --tile-sampling: full renders all tiles; none renders only tiles that are simulated or warm caches,\n"
          "and writes no picture")
      ->check(CLI::IsMember({"full", "none"}))
      ->capture_default_str();
  verb->add_option("--slices", options->slices,
                   "split the frame's tiles into this number of slices, simulate them concurrently, each on its own\n"
                   "machine, and add the results, with 95 % intervals: a number, or auto (docs/slices.md)")
      ->check([](const std::string& text) { return text.empty() ? std::string("is empty; allowed: 2, auto") : ""; });
  verb->add_option("--replicates", options->replicates,
                   "simulate the frame this number of times, all but the first with small timing perturbations, and\n"
                   "report mean and 95 % interval of each metric (docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  add_intervals_option(*verb, *options);
  verb->add_flag(
          "--watch", options->watch,
          "show the unfinished picture, utilisation and power of the last interval, and the expected end; print a\n"
          "line every two seconds if standard output is not a terminal")
      ->excludes(verb->get_option("--progress"), verb->get_option("--quiet"));
  add_timeline_option(*verb, *options);
  verb->add_flag("--json", options->json, "print the totals of report.json as JSON instead of the table");
  add_rays_option(*verb, *options);
  verb->footer("Example: raywatt run sgrt-2016 --scene teapot --set cores=2 -o out/two-cores");
  verb->callback([options] { options->rays.empty() ? run_frames(*options) : run_rays(*options); });
}

void add_verify_command(CLI::App& app, const std::vector<std::string>& argv, int& exit) {
  CLI::App* verb = app.add_subcommand("verify", "Compare every ray, primary and secondary, with Embree");
  const auto options = std::make_shared<JobOptions>();
  options->argv = argv;
  add_work_options(*verb, *options);
  add_frames_option(*verb, *options);
  add_output_options(*verb, *options);
  add_rays_option(*verb, *options);
  verb->footer(
      "Example: raywatt verify --scene teapot --resolution 512x256\nExit code 1 if a ray differs, except for ties at "
      "edges.");
  verb->callback([options, &exit] { exit = options->rays.empty() ? verify_frames(*options) : verify_rays(*options); });
}

namespace {

/// Positional arguments of a verb: an optional configuration, then a trace file.
struct Arguments {
  std::vector<std::string> words;
  const std::string& trace_file() const { return words.back(); }
  bool has_config() const { return words.size() == 2; }
};

void add_arguments(CLI::App& verb, Arguments& arguments) {
  verb.add_option("arguments", arguments.words, "an optional configuration, and the trace file")
      ->required()
      ->expected(1, 2)
      ->type_name("[CONFIG] FILE");
}

void add_record(CLI::App& group, const std::vector<std::string>& argv) {
  CLI::App* verb =
      group.add_subcommand("record", "Write the work of a run to a trace file, without simulating a machine");
  const auto options = std::make_shared<JobOptions>();
  const auto arguments = std::make_shared<Arguments>();
  options->argv = argv;
  add_arguments(*verb, *arguments);
  add_work_options(*verb, *options, false);
  add_frames_option(*verb, *options);
  add_reference_option(*verb, *options);
  verb->add_flag("--quiet", options->quiet, "print nothing");
  add_progress_option(*verb, options->progress);
  verb->footer("Example: raywatt trace record --scene chess --resolution 512x256 chess.trace");
  verb->callback([=] {
    if (arguments->has_config()) options->config = arguments->words.front();
    record_trace(*options, arguments->trace_file());
  });
}

void add_replay(CLI::App& group, const std::vector<std::string>& argv) {
  CLI::App* verb = group.add_subcommand(
      "replay", "Simulate a trace on a machine; the report equals that of a run, without pictures");
  const auto options = std::make_shared<JobOptions>();
  const auto arguments = std::make_shared<Arguments>();
  options->argv = argv;
  add_arguments(*verb, *arguments);
  add_set_option(*verb, options->sets);
  add_fps_option(*verb, options->sets);
  add_ideal_option(*verb, *options);
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  add_intervals_option(*verb, *options);
  add_output_options(*verb, *options);
  add_timeline_option(*verb, *options);
  verb->footer(
      "Without CONFIG, the recorded machine is used. Keys that change the work must have their recorded values.\n\n"
      "Example: raywatt trace replay chess.trace --set cores=2 -o out/two-cores");
  verb->callback([=] {
    options->config = arguments->has_config() ? arguments->words.front() : "";
    replay_trace(*options, arguments->trace_file());
  });
}

void add_info(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("info", "Print what a trace contains");
  const auto file = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("file", *file, "the trace file")->required();
  verb->add_flag("--json", *json, "print JSON");
  verb->footer("Example: raywatt trace info chess.trace --json");
  verb->callback([=] {
    const sim::Json info = trace_info(traces::TraceReader(*file));
    fmt::print("{}", *json ? sim::json_lines(info) : trace_info_text(info));
  });
}

}  // namespace

void add_trace_command(CLI::App& app, const std::vector<std::string>& argv) {
  CLI::App* verb = app.add_subcommand("trace", "Record the work of a run once, and simulate it on any machine");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt trace replay chess.trace --set cores=2");
  add_record(*verb, argv);
  add_replay(*verb, argv);
  add_info(*verb);
}

}  // namespace tools
