#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/report/report_json.h"
#include "tools/analysis/trace_info.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/run/jobs.h"
#include "traces/trace_file/trace_reader.h"

namespace tools {
namespace {

/// The arguments "[CONFIG] FILE".
struct Arguments {
  std::vector<std::string> words;
  const std::string& file() const { return words.back(); }
  bool has_config() const { return words.size() == 2; }
};

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
  verb->callback([=] {
    if (arguments->has_config()) options->config = arguments->words.front();
    record_trace(*options, arguments->file());
  });
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
  add_intervals_option(*verb, *options);
  add_output_options(*verb, *options);
  add_timeline_option(*verb, *options);
  verb->footer(
      "Without CONFIG: on the machine that it was recorded with. Keys that change the work must be as recorded.\n\n"
      "Example: raywatt trace replay chess.trace --set cores=2 -o out/two-cores");
  verb->callback([=] {
    options->config = arguments->has_config() ? arguments->words.front() : "";
    replay_trace(*options, arguments->file());
  });
}

void add_info(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("info", "What a file holds");
  const auto file = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("file", *file, "the trace")->required();
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt trace info chess.trace --json");
  verb->callback([=] {
    const sim::Json info = trace_info(traces::TraceReader(*file));
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
