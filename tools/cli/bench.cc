#include "tools/studies/bench/bench.h"

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/io/json.h"
#include "sim/report/report_json.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {
namespace {

void run_bench(const BenchOptions& options, bool json) {
  sim::Json other;
  if (!options.against.empty()) other = load_bench(options.against);
  sim::Json out = options.saved_metrics.empty() ? measure_scenes(options, options.against.empty() ? nullptr : &other)
                                                : load_bench(options.saved_metrics);
  if (!options.against.empty()) {
    check_comparable(out, other, options.against);
    compare_bench(out, other);
  }
  fmt::print("{}", json ? sim::json_text(out) : bench_table(out));
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bench", "Measure the speed of the simulator: rendering, timing, whole runs, replays and sampled tiles");
  const auto options = std::make_shared<BenchOptions>();
  const auto json = std::make_shared<bool>(false);
  add_config_options(*verb, options->job.config, options->job.sets);
  verb->add_option("--scene", options->scenes, "scenes to measure (repeatable)")->capture_default_str();
  verb->add_option("--program", options->job.program, "frame program, as of raywatt run")->capture_default_str();
  verb->add_option("--resolution", options->job.resolution, "WIDTHxHEIGHT (default: the configuration's)");
  verb->add_option("--threads", options->job.threads, "host threads of the whole run (default: all cores)")
      ->check(CLI::Range(1, 1024));
  verb->add_option("--runs", options->runs, "rounds; results are medians over them")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--against", options->against, "JSON of another build; also print the ratio of each result");
  CLI::Option* saved_metrics =
      verb->add_option("--measured", options->saved_metrics, "JSON of this build, instead of measuring");
  for (const char* of_measuring : {"config", "--set", "--scene", "--program", "--resolution", "--threads", "--runs"}) {
    saved_metrics->excludes(verb->get_option(of_measuring));
  }
  verb->add_flag("--json", *json, "print JSON");
  add_progress_option(*verb, options->job.progress);
  verb->footer(
      "Example: raywatt bench --scene chess --resolution 512x256 --against main.json\n"
      "tools/scripts/bench_against REV builds another revision and measures both in turn.");
  verb->callback([=] { run_bench(*options, *json); });
}

namespace {

void print_benchmarks(CLI::App& verb) {
  for (const CLI::App* benchmark : verb.get_subcommands([](const CLI::App*) { return true; })) {
    if (benchmark->get_name() != "list") fmt::print("{:<13}{}\n", benchmark->get_name(), benchmark->get_description());
  }
}

CLI::Option* add_value(CLI::App& app, const BenchmarkOption& option, bool& value) {
  return app.add_flag(option.name, value, option.meaning);
}

CLI::Option* add_value(CLI::App& app, const BenchmarkOption& option, auto& value) {
  return app.add_option(option.name, value, option.meaning)->allow_extra_args(false);
}

void add_option(CLI::App& app, const BenchmarkOption& option, BenchmarkJob& job) {
  CLI::Option* made = std::visit([&](auto member) { return add_value(app, option, job.*member); }, option.member);
  if (!option.words.empty()) made->check(CLI::IsMember(option.words));
  if (option.most != 0) made->check(CLI::Range(1, option.most));
  if (option.default_shown) made->capture_default_str();
}

/// Prints the findings. If values differ from their closed forms, prints a message and sets `exit` to kCheckFailed.
void print_findings(const Findings& findings, const char* name, bool json, int& exit) {
  const bool ready = !findings.printed.empty();
  fmt::print("{}", ready ? findings.printed : json ? json_of(name, findings) : table_of(findings));
  const auto missed = std::ranges::count_if(findings.measurements, [](const Measurement& m) { return !m.is_good(); });
  if (missed == 0) return;
  exit = kCheckFailed;
  print_message("{} of {} values differ from their closed forms", missed, findings.measurements.size());
}

void add_benchmark(CLI::App& verb, const Benchmark& benchmark, int& exit) {
  CLI::App* app = verb.add_subcommand(benchmark.name, benchmark.meaning);
  const auto job = std::make_shared<BenchmarkJob>();
  add_config_options(*app, job->machine.config, job->machine.sets);
  for (const BenchmarkOption& option : benchmark.options) add_option(*app, option, *job);
  app->footer(benchmark.footer);
  app->callback([name = benchmark.name, measure = benchmark.measure, job, &exit] {
    print_table_warnings(job->machine);
    print_findings(measure(*job), name, job->json, exit);
  });
}

}  // namespace

void add_microbench(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("microbench", "Measure parts of the machine and compare them with closed forms");
  verb->require_subcommand(1);
  verb->footer(
      "Exit code 1 if a value differs from its closed form by more than the tolerance.\n\n"
      "Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400");
  verb->add_subcommand("list", "List the benchmarks")->callback([verb] { print_benchmarks(*verb); });
  for (const auto& benchmark : {chase_benchmark, bandwidth_benchmark, mshr_benchmark, dram_benchmark, rays_benchmark,
                                early_exit_benchmark, tile_buffer_benchmark, kernels_benchmark}) {
    add_benchmark(*verb, benchmark(), exit);
  }
}

}  // namespace tools
