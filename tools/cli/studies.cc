#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "sim/error.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "sim/report/table.h"
#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/host/progress.h"
#include "tools/host/standard_streams.h"
#include "tools/pricing/priced_run.h"
#include "tools/run/frame/job_options.h"
#include "tools/studies/baseline/baseline.h"
#include "tools/studies/bench/bench.h"
#include "tools/studies/bottleneck/bottleneck.h"
#include "tools/studies/compare/compare.h"
#include "tools/studies/compare/compare_sets.h"
#include "tools/studies/microbench/benchmark.h"
#include "tools/studies/optimise/optimise.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/report/report.h"
#include "tools/studies/report/vendor_counters.h"
#include "tools/studies/reproduce/plan.h"
#include "tools/studies/reproduce/reproduce.h"
#include "tools/studies/worth/worth.h"

namespace tools {

void add_report_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("report", "Write a self-contained HTML report of a run, a comparison or a sweep");
  const auto options = std::make_shared<pages::Options>();
  verb->add_option(
          "what", options->inputs,
          "folder of a run; folders of several runs, which are compared with the first; or folder of a sweep or a\n"
          "search")
      ->required()
      ->expected(1, 16)
      ->type_name("DIR...");
  CLI::Option* out = verb->add_option("-o,--output", options->out, "the HTML file; with --counters, a CSV file");
  out->type_name("FILE");
  verb->add_option("--counters", options->counters,
                   "print a run's ray-tracing counters by the names of a vendor's GPU (docs/counters.md)")
      ->check(CLI::IsMember({"mali_g1", "mali_g715", "adreno7xx"}))
      ->type_name("GPU");
  verb->add_flag("--force", options->force, "replace a file that is not a report page or a table of counters");
  verb->footer(
      "Example: raywatt report raywatt-out/base -o base.html\n"
      "         raywatt report raywatt-out/base raywatt-out/ports -o difference.html\n"
      "         raywatt report out/trv-cores -o sweep.html\n"
      "         raywatt report raywatt-out/base --counters mali_g1");
  verb->callback([options, out] {
    if (!options->counters.empty()) {
      fmt::print("{}", to_terminal_encoding(pages::report_counters(*options)));
      return;
    }
    if (out->count() == 0) throw CLI::RequiredError("--output");
    pages::write_report_page(*options);
    fmt::print("page: {}\n", options->out.string());
  });
}

void add_reproduce_command(CLI::App& app, const std::vector<std::string>& argv) {
  CLI::App* verb =
      app.add_subcommand("reproduce", "Run a paper's experiments, and print measured and published values");
  const auto options = std::make_shared<reproduce::Options>();
  options->argv = argv;
  std::vector<std::string_view> papers;
  for (const reproduce::Paper& paper : reproduce::all_papers()) papers.push_back(paper.name);
  verb->add_option("paper", options->paper, fmt::format("{}", fmt::join(papers, ", ")))->required();
  verb->add_option("--scenes", options->scenes, "folder of .glb files for scenes without a built-in substitute");
  verb->add_flag(
      "--quick", options->quick,
      "run only some experiments, at a sixteenth of the resolution and with fewer triangles, as a quick check");
  verb->add_option("--shrink", options->shrink, "divide width and height of all pictures by this number")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb->add_option("--config", options->config, "configuration: a name such as sgrt-2016, or a .yaml file")
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  verb->add_option("-o,--output", options->out, "folder for the results (default: a dated one below raywatt-out/)");
  verb->add_flag("--force", options->force, "write into the folder even if it has other files, which are kept");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "Example: raywatt reproduce kim2016 --scenes ~/scenes -o out/kim2016\n"
      "Whole papers take hours. Finished rows are kept: the same command continues from them after an interrupt,\n"
      "and starts again when all rows are finished (docs/reproduce.md).");
  verb->callback([options] { reproduce::reproduce(*options); });
}

void add_optimise_command(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("optimise", "Multi-objective design-space search");
  verb->alias("optimize");
  const auto options = std::make_shared<optimise::Options>();
  verb->add_option("file", options->file,
                   "the search: a name such as optimise-cores, or a .yaml file (docs/optimise.md)")
      ->required();
  verb->add_option("-o,--output", options->out, "folder (default: raywatt-out/optimise-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, shared with sweeps (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_option("--budget", options->budget, "number of machines to simulate (default: the file's, or 100)")
      ->check(CLI::Range(optimise::kLeastBudget, optimise::kMostBudget));
  refuse_negative(*verb->add_option("--seed", options->seed, "random seed (default: the file's, or 1)"));
  verb->add_option("--fidelity", options->fidelity,
                   "full: whole frames; tiles: tile sampling, then whole frames of the best; sampled: first looks by\n"
                   "tile sampling, then whole frames; auto: tiles for large pictures (default: the file's, or auto)")
      ->check(CLI::IsMember({"auto", "full", "sampled", "tiles"}));
  add_set_option(*verb, options->sets);
  verb->add_option("--confidence", options->confidence,
                   "required probability that each limit is met, by the noise and the bands of the energy and area\n"
                   "tables (default: the file's, or nominal values)")
      ->check(CLI::Validator(
          [](const std::string& text) {
            double share = 0;
            return CLI::detail::lexical_cast(text, share) && optimise::is_confidence(share)
                       ? std::string()
                       : std::string(optimise::kConfidenceRange);
          },
          "PROBABILITY"));
  verb->add_flag("--check", options->check,
                 "simulate whole frames of the best machines, and state which limits they meet");
  add_fps_option(*verb, options->sets);
  verb->add_flag("--quiet", options->quiet, "print no table and no progress bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command continues an interrupted search. Exit code 1 if no machine meets the constraints, or runs\n"
      "failed.\n\n"
      "Example: raywatt optimise optimise-cores -o out/best -j 4");
  verb->callback([options, &exit] {
    options->file = find_experiment(options->file);
    exit = optimise::run(*options);
  });
}

void add_worth_command(CLI::App& app, int& exit) {
  CLI::App* verb =
      app.add_subcommand("worth", "Measure what a feature is worth: the smallest machine without and with it");
  const auto options = std::make_shared<worth::Options>();
  optimise::Options& search = options->search;
  verb->add_option("file", search.file,
                   "the feature: a name such as adaptive-sampling, or a .yaml file (docs/worth.md)")
      ->required();
  verb->add_option("-o,--output", search.out, "folder (default: raywatt-out/worth-NAME)");
  verb->add_option("--store", search.store,
                   "folder of results, shared with sweeps (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, search);
  verb->add_option("--budget", search.budget, "number of machines to simulate per side (default: the file's, or 100)")
      ->check(CLI::Range(optimise::kLeastBudget, optimise::kMostBudget));
  refuse_negative(*verb->add_option("--seed", search.seed, "random seed (default: the file's, or 1)"));
  add_fps_option(*verb, search.sets);
  verb->add_flag("--check", options->check, "also simulate all machines, and compare the best with the search's");
  verb->add_option("--page", options->page, "write an HTML page that compares both machines")->type_name("FILE.html");
  verb->add_flag("--json", options->json, "print JSON");
  verb->add_flag("--quiet", search.quiet, "no table, no bar");
  add_progress_option(*verb, search.progress);
  verb->footer(
      "The same command continues an interrupted search. Exit code 1 if no machine meets the constraints, simulations\n"
      "failed, or --check found a machine that is more than 2 % better.\n\n"
      "Example: raywatt worth adaptive-sampling -o out/worth -j 4");
  verb->callback([options, &exit] {
    options->search.file = find_experiment(options->search.file, "worth");
    exit = worth::run(*options);
  });
}

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
  fmt::print("{}", json ? sim::json_lines(out) : bench_table(out));
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bench", "Measure the speed of the simulator: rendering, timing, whole runs, replays and sampled tiles");
  const auto options = std::make_shared<BenchOptions>();
  const auto json = std::make_shared<bool>(false);
  add_config_options(*verb, options->job.config, options->job.sets);
  verb->add_option("--scene", options->scenes, "scenes to measure (repeatable)")->capture_default_str();
  verb->add_option("--program", options->job.program, "frame program, as in raywatt run")->capture_default_str();
  verb->add_option("--resolution", options->job.resolution, "WIDTHxHEIGHT (default: the configuration's)");
  verb->add_option("--threads", options->job.threads, "host threads of the whole run (default: all cores)")
      ->check(CLI::Range(1, 1024));
  verb->add_option("--runs", options->runs, "rounds; results are medians over them")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  verb->add_option("--against", options->against,
                   "results of another build (JSON): also print the ratio of each result");
  CLI::Option* saved_metrics = verb->add_option("--measured", options->saved_metrics,
                                                "read the results of this build from JSON instead of measuring");
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

/// Prints the findings of a microbenchmark. If values differ from their closed forms, also prints a message and sets
/// `exit` to kCheckFailed.
void print_findings(const Findings& findings, const char* name, bool json, int& exit) {
  const bool ready = !findings.printed.empty();
  fmt::print("{}", ready ? findings.printed : json ? findings_json(name, findings) : findings_table(findings));
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
    print_technology_table_warnings(job->machine);
    print_findings(measure(*job), name, job->json, exit);
  });
}

}  // namespace

void add_microbench_command(CLI::App& app, int& exit) {
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

namespace {

struct CompareOptions {
  std::vector<std::string> paths, with, metrics;
  std::uint32_t replicates = 1, threads = 0;
  double fps = 0;
  std::string progress = "auto";
  bool json = false;
};

/// Simulates the replicates that the options request and adds their statistics to the reports. Also adds the metrics at
/// the requested frame rate.
void complete_reports(const CompareOptions& options, const std::vector<ReportFile*>& reports) {
  if (options.replicates > 1) {
    Progress progress(options.progress, false);
    progress.expect_parts(options.replicates * static_cast<std::uint32_t>(reports.size()));
    for (ReportFile* report : reports) add_replicates(*report, options.replicates, options.threads, &progress);
    progress.finish("done");
  }
  if (options.fps > 0) {
    for (ReportFile* report : reports) set_frame_rate(*report, options.fps);
  }
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) print_message("warning: {}", sim::printable(warning, 1000));
}

/// Reads the sets of runs to compare. A set is a folder that contains runs, or one of two lists of runs. Returns no
/// sets if the options name single runs.
std::vector<RunSet> load_run_sets(const CompareOptions& options) {
  std::vector<RunSet> sets;
  const auto is_set = [](const std::string& path) { return is_run_set(path); };
  if (!options.with.empty()) {
    for (const auto& [name, paths] : {std::pair{"first", &options.paths}, {"second", &options.with}}) {
      RunSet& set = sets.emplace_back(RunSet{name, {}});
      for (const std::string& path : *paths) set.runs.push_back(load_report(path));
    }
  } else if (std::ranges::any_of(options.paths, is_set)) {
    for (const std::string& path : options.paths) {
      if (!is_set(path)) {
        throw sim::InputError(fmt::format(
            "{}: is no folder of runs, as another is; allowed: only folders that contain runs, or only runs "
            "(with report.json)",
            sim::printable(path)));
      }
      sets.push_back(load_run_set(path));
    }
  }
  return sets;
}

void compare_run_sets(const CompareOptions& options, std::vector<RunSet> sets) {
  std::vector<ReportFile*> reports;
  for (RunSet& set : sets) {
    for (ReportFile& run : set.runs) reports.push_back(&run);
  }
  complete_reports(options, reports);
  std::vector<SetComparison> against;
  for (std::size_t i = 1; i < sets.size(); ++i) against.push_back(compare_sets(sets.front(), sets[i], options.metrics));
  print_warnings(set_comparison_warnings(sets, against));
  fmt::print("{}", options.json ? sim::json_lines(set_comparison_json(sets, against))
                                : to_terminal_encoding(set_comparison_text(sets, against)));
}

void run_comparison(const CompareOptions& options) {
  if (options.paths.size() < 2 && options.with.empty()) {
    throw sim::InputError("runs: 1 given; allowed: at least 2, or --with RUN... for the second set");
  }
  if (std::vector<RunSet> sets = load_run_sets(options); !sets.empty()) {
    return compare_run_sets(options, std::move(sets));
  }
  if (!options.metrics.empty()) {
    throw sim::InputError(
        "--metric is for sets of runs; allowed: folders that contain runs, or --with; of single runs --json has all");
  }
  std::vector<ReportFile> reports;
  std::vector<ReportFile*> all;
  for (const std::string& path : options.paths) reports.push_back(load_report(path));
  for (ReportFile& report : reports) all.push_back(&report);
  complete_reports(options, all);
  std::vector<Comparison> against;
  for (std::size_t i = 1; i < reports.size(); ++i) against.push_back(compare(reports.front(), reports[i]));
  print_warnings(comparison_warnings(reports, against));
  fmt::print("{}", options.json ? sim::json_lines(comparison_json(reports, against))
                                : to_terminal_encoding(comparison_text(reports, against)));
}

}  // namespace

void add_compare_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "compare", "Compare runs: print changes of cycles, energy and pictures, and the counters that explain them");
  const auto options = std::make_shared<CompareOptions>();
  verb->add_option("runs", options->paths,
                   "folders of runs, or report.json files; all are compared with the first. Folders that contain runs\n"
                   "are sets: runs of one machine on several workloads, which are compared workload by workload")
      ->required()
      ->expected(1, 100)
      ->type_name("RUN RUN...");
  verb->add_option("--with", options->with, "runs of the second set; the positional RUN... are the first set")
      ->expected(1, 100)
      ->type_name("RUN...");
  verb->add_option(
          "--metric", options->metrics,
          "of sets: print only this metric: PATH, worst(PATH), mean(PATH), geomean(PATH) or on(WORKLOAD, PATH)\n"
          "(repeatable)")
      ->allow_extra_args(false)
      ->type_name("METRIC");
  verb->add_option(
          "--replicates", options->replicates,
          "simulate runs that have fewer replicates this number of times, slightly perturbed, to measure noise\n"
          "(docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads of the replicates (default: all cores)")
      ->check(CLI::Range(1, 1024));
  require_positive(*verb->add_option("--fps", options->fps,
                                     "target frame rate: also compare power_at_fps_w and fps_margin at it\n"
                                     "(docs/frame-rate.md)")
                        ->type_name("NUMBER"));
  add_progress_option(*verb, options->progress);
  verb->add_flag("--json", options->json, "print JSON, with all differences");
  verb->footer("Example: raywatt compare raywatt-out/base raywatt-out/two-ports\nExit code 0 for any difference.");
  verb->callback([=] { run_comparison(*options); });
}

namespace {

CLI::App* add_baseline_verb(CLI::App& verb, const char* name, const char* what,
                            const std::shared_ptr<BaselineOptions>& options, int& exit,
                            int (*run)(const BaselineOptions&)) {
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

void add_baseline_command(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("baseline", "Store the results of small runs, and detect changes");
  verb->require_subcommand(1);
  const auto options = std::make_shared<BaselineOptions>();
  CLI::App* step =
      add_baseline_verb(*verb, "record", "Compute a suite and store its values", options, exit, record_baseline);
  step->add_flag("--force", options->force, "replace stored values without showing changes");
  step->footer("Example: raywatt baseline record tests/baseline/suite.yaml");
  step = add_baseline_verb(*verb, "check", "Compute a suite and report changed values, and the unit that changed",
                           options, exit, check_baseline);
  step->add_option("--junit", options->junit,
                   "also write the result to this file as JUnit XML; replaces only a file of an earlier check");
  step->add_flag("--force", options->force, "with --junit: replace any file of that name");
  step->footer(
      "Example: raywatt baseline check tests/baseline/suite.yaml --junit baseline.xml\n"
      "Exit code 0: nothing changed; 1: something changed; 2: stored values are missing or belong to other inputs.");
  step = add_baseline_verb(*verb, "accept", "Show changed values and store them", options, exit, accept_baseline);
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

void add_bottleneck_command(CLI::App& app) {
  CLI::App* verb = app.add_subcommand(
      "bottleneck", "Measure the speed-up of a frame by each ideal resource, and print what limits the frame");
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
    fmt::print("{}", *json ? sim::json_lines(bottleneck_json(b)) : to_terminal_encoding(bottleneck_text(b)));
  });
}

}  // namespace tools
