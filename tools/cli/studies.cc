#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/host/progress.h"
#include "tools/studies/optimise/optimise.h"
#include "tools/studies/optimise/task.h"
#include "tools/studies/report/report.h"
#include "tools/studies/reproduce/reproduce.h"

namespace tools {

void add_report(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("report", "Write a self-contained HTML report of a run, a comparison or a sweep");
  const auto options = std::make_shared<pages::Options>();
  verb->add_option(
          "what", options->inputs,
          "folder of a run; folders of several runs, which are compared with the first; or folder of a sweep or a\n"
          "search")
      ->required()
      ->expected(1, 16)
      ->type_name("DIR");
  verb->add_option("-o,--output", options->out, "the HTML file; it needs no network")
      ->required()
      ->type_name("FILE.html");
  verb->add_flag("--force", options->force, "replace a file that is not a report page");
  verb->footer(
      "Example: raywatt report raywatt-out/base -o base.html\n"
      "         raywatt report raywatt-out/base raywatt-out/ports -o difference.html\n"
      "         raywatt report out/trv-cores -o sweep.html");
  verb->callback([options] {
    pages::write_report_page(*options);
    fmt::print("page: {}\n", options->out.string());
  });
}

void add_reproduce(CLI::App& app, const std::vector<std::string>& argv) {
  CLI::App* verb =
      app.add_subcommand("reproduce", "Run a paper's experiments, and print measured and published values");
  const auto options = std::make_shared<reproduce::Options>();
  options->argv = argv;
  verb->add_option("paper", options->paper, "lee2016, kim2016, jin2009, chiu, sgrt-units or hybrid")->required();
  verb->add_option("--scenes", options->scenes, "folder of .glb files for scenes without a built-in substitute");
  verb->add_flag("--quick", options->quick, "run some experiments at a sixteenth of the resolution, as a quick check");
  verb->add_option("--shrink", options->shrink, "divide width and height of all pictures by this number")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb->add_option("--config", options->config, "configuration: a name such as sgrt-2016, or a .yaml file")
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  verb->add_option("-o,--output", options->out, "folder for the results (default: a dated one below raywatt-out/)");
  verb->add_flag("--force", options->force, "write into a folder that is not an earlier run, among its files");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "Example: raywatt reproduce kim2016 --scenes ~/scenes -o out/kim2016\n"
      "Whole papers take hours. Finished rows are kept: the same command continues from them after an interrupt,\n"
      "and starts over once all rows are there (docs/reproduce.md).");
  verb->callback([options] { reproduce::reproduce(*options); });
}

void add_optimise(CLI::App& app, int& exit) {
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
  verb->add_option("--budget", options->budget, "number of points to simulate (default: the file's, or 100)")
      ->check(CLI::Range(optimise::kLeastBudget, optimise::kMostBudget));
  refuse_negative(*verb->add_option("--seed", options->seed, "random seed (default: the file's, or 1)"));
  verb->add_option("--fidelity", options->fidelity,
                   "sampled: evaluate points by tile sampling first (default: the file's)")
      ->check(CLI::IsMember({"full", "sampled"}));
  verb->add_flag("--quiet", options->quiet, "no table, no bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command continues an interrupted search. Exit code 1 if no point meets the constraints, or points\n"
      "failed.\n\n"
      "Example: raywatt optimise optimise-cores -o out/best -j 4");
  verb->callback([options, &exit] {
    options->file = find_experiment(options->file);
    exit = optimise::run(*options);
  });
}

}  // namespace tools
