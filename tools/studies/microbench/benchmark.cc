#include "tools/studies/microbench/benchmark.h"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/time.h"
#include "tools/cli/job_options.h"
#include "tools/host/exit_code.h"

namespace tools {

CLI::App* add_benchmark(CLI::App& verb, const Benchmark& benchmark, const std::shared_ptr<JobOptions>& job, int& exit,
                        std::function<Findings()> measure) {
  CLI::App* app = verb.add_subcommand(benchmark.name, benchmark.meaning);
  const auto json = std::make_shared<bool>(false);
  add_config_options(*app, job->config, job->sets);
  app->add_flag("--json", *json, "as JSON");
  app->footer(benchmark.footer);
  app->callback(
      [name = benchmark.name, json, job, &exit, measure = std::move(measure)] { show(measure(), name, *json, exit); });
  return app;
}

void show(const Findings& findings, const std::string& name, bool json, int& exit) {
  fmt::print("{}", json ? json_of(name, findings) : table_of(findings));
  const auto missed = std::ranges::count_if(findings.figures, [](const Figure& f) { return !f.good(); });
  if (missed == 0) return;
  exit = kCheckFailed;
  fmt::print(stderr, "raywatt: {} of {} figures leave their closed forms\n", missed, findings.figures.size());
}

RunConfig real_machine(const JobOptions& job) {
  RunConfig config = load_run_config(job);
  config.gpu.ideal = {};
  return config;
}

double steady_rate(std::vector<std::uint64_t> moments) {
  std::ranges::sort(moments);
  const std::size_t first = moments.size() / 10, last = moments.size() - 1 - first;
  return static_cast<double>(last - first) / static_cast<double>(moments[last] - moments[first]) *
         static_cast<double>(sim::kFemtosecondsPerSecond);
}

}  // namespace tools
