#include "tools/studies/compare/compare.h"

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/report_json.h"
#include "sim/report/table.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/job_options.h"
#include "tools/studies/baseline/baseline.h"
#include "tools/studies/bottleneck/bottleneck.h"

namespace tools {
namespace {

struct CompareOptions {
  std::vector<std::string> paths;
  std::uint32_t replicates = 1, threads = 0;
  std::string progress = "auto";
  bool json = false;
};

void run_comparison(const CompareOptions& options) {
  std::vector<ReportFile> reports;
  for (const std::string& path : options.paths) reports.push_back(load_report(path));
  if (options.replicates > 1) {
    Progress progress(options.progress, false);
    progress.expect_parts(options.replicates * static_cast<std::uint32_t>(reports.size()));
    for (ReportFile& report : reports) add_replicates(report, options.replicates, options.threads, &progress);
    progress.finish("done");
  }
  std::vector<Comparison> against;
  for (std::size_t i = 1; i < reports.size(); ++i) against.push_back(compare(reports.front(), reports[i]));
  for (const std::string& warning : comparison_warnings(reports, against)) {
    print_message("warning: {}", sim::printable(warning, 1000));
  }
  fmt::print("{}", options.json ? sim::json_text(comparison_json(reports, against))
                                : terminal_text(comparison_text(reports, against)));
}

}  // namespace

void add_compare(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "compare", "Compare runs: changes of cycles, energy and pictures, and the counters that explain them");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("runs", options->paths, "folders of runs, or report.json files; all are compared with the first")
      ->required()
      ->expected(2, 100)
      ->option_text("RUN RUN... REQUIRED");
  verb->add_option(
          "--replicates", options->replicates,
          "simulate runs that have fewer replicates this number of times, slightly perturbed, to measure noise\n"
          "(docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads of the replicates (default: all cores)")
      ->check(CLI::Range(1, 1024));
  add_progress_option(*verb, options->progress);
  verb->add_flag("--json", options->json, "print JSON, with all differences");
  verb->footer("Example: raywatt compare raywatt-out/base raywatt-out/two-ports\nExit code 0 for any difference.");
  verb->callback([=] { run_comparison(*options); });
}

namespace {

CLI::App* add_step(CLI::App& verb, const char* name, const char* what, const std::shared_ptr<BaselineOptions>& options,
                   int& exit, int (*run)(const BaselineOptions&)) {
  CLI::App* step = verb.add_subcommand(name, what);
  step->add_option("suite", options->suite, "the suite, a YAML file (docs/compare.md)")->required();
  step->add_option("-j,--jobs", options->jobs, "concurrent runs (default: all host threads)")
      ->check(CLI::Range(1, 1024));
  step->add_option("--replicates", options->replicates,
                   "simulate each run this number of times, slightly perturbed: a value with noise has changed if the\n"
                   "change exceeds the noise (docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  step->callback([=, &exit] { exit = run(*options); });
  return step;
}

}  // namespace

void add_baseline(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("baseline", "Store the results of small runs, and detect changes");
  verb->require_subcommand(1);
  const auto options = std::make_shared<BaselineOptions>();
  CLI::App* step = add_step(*verb, "record", "Compute a suite and store its values", options, exit, record_baseline);
  step->add_flag("--force", options->force, "replace stored values without showing changes");
  step->footer("Example: raywatt baseline record tests/baseline/suite.yaml");
  step = add_step(*verb, "check", "Compute a suite and report changed values, and the unit that changed", options, exit,
                  check_baseline);
  step->add_option("--junit", options->junit,
                   "also write the result as JUnit XML into this file: a new one, or one of an earlier check");
  step->add_flag("--force", options->force, "replace any file of that name");
  step->footer(
      "Example: raywatt baseline check tests/baseline/suite.yaml --junit baseline.xml\n"
      "Exit code 0: nothing changed; 1: something changed; 2: stored values are missing or of other inputs.");
  step = add_step(*verb, "accept", "Show changed values and store them", options, exit, accept_baseline);
  step->footer("Example: raywatt baseline accept tests/baseline/suite.yaml");
  verb->footer("Example: raywatt baseline check tests/baseline/suite.yaml");
}

namespace {

using sim::Json;

std::string bottleneck_text(const Bottleneck& b) {
  std::string out =
      fmt::format("{} cycles of the T&I clock\nlimited by (estimate)  {}\ntime goes to           {}\n\n",
                  sim::si_text(static_cast<double>(b.cycles)), b.limiter, top_down_text(time_json(b.time)));
  const bool replicated = b.plays.count > 1;
  sim::Table table({"ideal", "cycles", "speed-up", "estimated",
                    replicated ? fmt::format("noise, {} runs", b.plays.count) : "noise, assumed"});
  for (const Bound& bound : b.bounds) {
    const NoisySpeedup s = noisy_speedup(b, bound);
    const std::string mean = replicated ? fmt::format("mean {:.3f} ", s.value) : "";
    table.add_row({bound.resource, sim::si_text(static_cast<double>(bound.cycles)),
                   fmt::format("{:.3f}", b.speedup_of(bound)), fmt::format("{:.2f}", bound.estimated),
                   fmt::format("{}± {:.2g}, {}", mean, s.half_width, s.outside ? "outside" : "within")});
  }
  sim::Table caches({"first-level caches", "hits", "cycles per miss", "share of time"});
  for (const CacheShare& cache : b.caches) {
    caches.add_row({cache.name, fmt::format("{:.1f} %", 100 * cache.hit_rate),
                    fmt::format("{:.1f}", cache.cycles_a_miss), fmt::format("{:.1f} %", 100 * cache.share)});
  }
  const char* const note =
      replicated ? "" : "noise: assumed for this size of picture; --replicates 5 measures it (docs/noise.md)\n";
  return out + table.text() + note + "\n" + caches.text();
}

Json bottleneck_json(const Bottleneck& b) {
  Json bounds = Json::object();
  for (const Bound& bound : b.bounds) {
    bounds[bound.resource] = {
        {"cycles", bound.cycles}, {"speedup", b.speedup_of(bound)}, {"estimated_speedup", bound.estimated}};
    const NoisySpeedup s = noisy_speedup(b, bound);
    bounds[bound.resource]["noise"] = {{"from", b.plays.count > 1 ? "replicates" : "default"},
                                       {"plays", b.plays.count},
                                       {"speedup", s.value},
                                       {"half_width", s.half_width},
                                       {"outside", s.outside}};
  }
  Json caches = Json::object();
  for (const CacheShare& cache : b.caches) {
    caches[cache.name] = {{"hit_rate", cache.hit_rate}, {"cycles_a_miss", cache.cycles_a_miss}, {"share", cache.share}};
  }
  return {{"schema", "raywatt-bottleneck/1"}, {"cycles", b.cycles}, {"limiter", b.limiter}, {"named", b.named},
          {"top_down", time_json(b.time)},    {"bounds", bounds},   {"caches", caches},     {"warnings", b.warnings}};
}

}  // namespace

void add_bottleneck(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bottleneck", "Speed-up of a frame if one resource is ideal, for each resource, and what limits the frame");
  const auto options = std::make_shared<JobOptions>();
  const auto json = std::make_shared<bool>(false);
  add_work_options(*verb, *options);
  verb->add_option(
          "--replicates", options->replicates,
          "simulate every machine this number of times, slightly perturbed, and report which speed-ups exceed the\n"
          "noise (docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  verb->add_flag("--json", *json, "print JSON");
  add_progress_option(*verb, options->progress);
  verb->footer("Example: raywatt bottleneck sgrt-2016 --scene chess --resolution 512x256");
  verb->callback([=] {
    Progress progress(options->progress, options->quiet);
    const Bottleneck b = find_bottleneck(*options, &progress);
    progress.finish("done");
    fmt::print("{}", *json ? sim::json_text(bottleneck_json(b)) : terminal_text(bottleneck_text(b)));
  });
}

}  // namespace tools
