#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/standard_streams.h"
#include "tools/studies/microbench/benchmark.h"

namespace tools {
namespace {

void list(CLI::App& verb) {
  for (const CLI::App* benchmark : verb.get_subcommands([](const CLI::App*) { return true; })) {
    if (benchmark->get_name() != "list") fmt::print("{:<13}{}\n", benchmark->get_name(), benchmark->get_description());
  }
}

CLI::Option* add(CLI::App& app, const BenchmarkOption& option, bool& value) {
  return app.add_flag(option.name, value, option.meaning);
}

CLI::Option* add(CLI::App& app, const BenchmarkOption& option, auto& value) {
  return app.add_option(option.name, value, option.meaning)->allow_extra_args(false);
}

void add_option(CLI::App& app, const BenchmarkOption& option, BenchmarkJob& job) {
  CLI::Option* made = std::visit([&](auto member) { return add(app, option, job.*member); }, option.member);
  if (!option.words.empty()) made->check(CLI::IsMember(option.words));
  if (option.most != 0) made->check(CLI::Range(1, option.most));
  if (option.default_shown) made->capture_default_str();
}

/// Prints the findings. If values differ from their closed forms, prints a message and sets `exit` to kCheckFailed.
void show(const Findings& findings, const char* name, bool json, int& exit) {
  const bool ready = !findings.printed.empty();
  fmt::print("{}", ready ? findings.printed : json ? json_of(name, findings) : table_of(findings));
  const auto missed = std::ranges::count_if(findings.figures, [](const Figure& f) { return !f.good(); });
  if (missed == 0) return;
  exit = kCheckFailed;
  tell("{} of {} figures leave their closed forms", missed, findings.figures.size());
}

void add_benchmark(CLI::App& verb, const Benchmark& benchmark, int& exit) {
  CLI::App* app = verb.add_subcommand(benchmark.name, benchmark.meaning);
  const auto job = std::make_shared<BenchmarkJob>();
  add_config_options(*app, job->machine.config, job->machine.sets);
  for (const BenchmarkOption& option : benchmark.options) add_option(*app, option, *job);
  app->footer(benchmark.footer);
  app->callback(
      [name = benchmark.name, measure = benchmark.measure, job, &exit] { show(measure(*job), name, job->json, exit); });
}

}  // namespace

void add_microbench(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("microbench", "Pieces of the machine alone, measured beside their closed forms");
  verb->require_subcommand(1);
  verb->footer(
      "A figure that leaves its closed form by more than it may ends the verb with exit code 1.\n\n"
      "Example: raywatt microbench dram --set dram.extends=dram/lpddr5-6400");
  verb->add_subcommand("list", "What each of them measures")->callback([verb] { list(*verb); });
  for (const auto& benchmark : {chase_benchmark, bandwidth_benchmark, mshr_benchmark, dram_benchmark, rays_benchmark,
                                early_exit_benchmark, tile_buffer_benchmark, kernels_benchmark}) {
    add_benchmark(*verb, benchmark(), exit);
  }
}

}  // namespace tools
