#include "tools/studies/bench/bench.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"

namespace tools {
namespace {

void bench(const BenchOptions& options, bool json) {
  sim::Json other;
  if (!options.against.empty()) other = load_bench(options.against);
  sim::Json out = options.measured.empty() ? measure_scenes(options, options.against.empty() ? nullptr : &other)
                                           : load_bench(options.measured);
  if (!options.against.empty()) {
    check_comparable(out, other, options.against);
    compare_bench(out, other);
  }
  fmt::print("{}", json ? sim::json_text(out) : bench_table(out));
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bench", "How fast the simulator is: functional half, timing, whole runs, replays and sampled tiles");
  const auto options = std::make_shared<BenchOptions>();
  const auto json = std::make_shared<bool>(false);
  add_config_options(*verb, options->job.config, options->job.sets);
  verb->add_option("--scene", options->scenes, "scenes to measure (repeatable)")->capture_default_str();
  verb->add_option("--program", options->job.program, "frame program, as of raywatt run")->capture_default_str();
  verb->add_option("--resolution", options->job.resolution, "WIDTHxHEIGHT (default: the configuration's)");
  verb->add_option("--threads", options->job.threads, "host threads of the whole run (default: all cores)")
      ->check(CLI::Range(1, 1024));
  verb->add_option("--runs", options->runs, "rounds; figures are medians over them")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--against", options->against, "JSON of another build: also how many times as good each figure is");
  CLI::Option* measured = verb->add_option("--measured", options->measured, "JSON of this build, instead of measuring");
  for (const char* of_measuring : {"config", "--set", "--scene", "--program", "--resolution", "--threads", "--runs"}) {
    measured->excludes(verb->get_option(of_measuring));
  }
  verb->add_flag("--json", *json, "as JSON");
  add_progress_option(*verb, options->job.progress);
  verb->footer(
      "Example: raywatt bench --scene chess --resolution 512x256 --against main.json\n"
      "tools/scripts/bench_against REV builds another revision and measures both in turn.");
  verb->callback([=] { bench(*options, *json); });
}

}  // namespace tools
