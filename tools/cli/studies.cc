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
  CLI::App* verb =
      app.add_subcommand("report", "A page to look at and to send: of a run, of runs side by side, of a sweep");
  const auto options = std::make_shared<pages::Options>();
  verb->add_option(
          "what", options->what,
          "folder of a run; folders of two or more runs, which are held against the first; or folder of a sweep\n"
          "or a search")
      ->required()
      ->expected(1, 16)
      ->type_name("DIR");
  verb->add_option("-o,--output", options->out, "the page, one file that needs no network")
      ->required()
      ->type_name("FILE.html");
  verb->add_flag("--force", options->force, "replace a file that is no such page");
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
  CLI::App* verb = app.add_subcommand("reproduce", "Run a paper's experiments; print measured beside published");
  const auto options = std::make_shared<reproduce::Options>();
  options->argv = argv;
  verb->add_option("paper", options->paper, "lee2016, kim2016, jin2009, chiu, sgrt-units or hybrid")->required();
  verb->add_option("--scenes", options->scenes, "folder of .glb files for scenes that no built-in one stands in for");
  verb->add_flag("--quick", options->quick,
                 "some of the experiments at a sixteenth of the resolution, to see that they run");
  verb->add_option("--shrink", options->shrink,
                   "divide the width and height of all pictures by this: all experiments, in a fraction of the time")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  verb->add_option("--config", options->config, "configuration: a name such as sgrt-2016, or a .yaml file")
      ->capture_default_str();
  verb->add_option("--threads", options->threads, "host threads (default: all cores)")->check(CLI::Range(1, 1024));
  verb->add_option("-o,--output", options->out, "folder for the results (default: a dated one below raywatt-out/)");
  verb->add_flag("--force", options->force, "put the results among the files of a folder that is not a former run");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "Example: raywatt reproduce kim2016 --scenes ~/scenes -o out/kim2016\n"
      "Whole papers take hours. Rows are kept as they finish, and the same command goes on from them, however the\n"
      "run was stopped; if all of them are there, it makes them anew. docs/reproduce.md tells more.");
  verb->callback([options] { reproduce::reproduce(*options); });
}

void add_optimise(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("optimise", "Search a space for its best points in one or two figures");
  verb->alias("optimize");
  const auto options = std::make_shared<optimise::Options>();
  verb->add_option(
          "file", options->file,
          "the space and what is asked of it: a name such as optimise-cores, or a .yaml file (docs/optimise.md)")
      ->required();
  verb->add_option("-o,--output", options->out, "folder (default: raywatt-out/optimise-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, the sweeps' (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_option("--budget", options->budget, "different points that are simulated (default: the file's, or 100)")
      ->check(CLI::Range(optimise::kLeastBudget, optimise::kMostBudget));
  refuse_negative(*verb->add_option("--seed", options->seed, "of all that is drawn (default: the file's, or 1)"));
  verb->add_option("--fidelity", options->fidelity, "sampled: first looks by tile sampling (default: the file's)")
      ->check(CLI::IsMember({"full", "sampled"}));
  verb->add_flag("--quiet", options->quiet, "no table, no bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command again goes on where it was stopped. Ends with 1 if no point meets the constraints, or points "
      "failed.\n\n"
      "Example: raywatt optimise optimise-cores -o out/best -j 4");
  verb->callback([options, &exit] {
    options->file = find_experiment(options->file);
    exit = optimise::run(*options);
  });
}

}  // namespace tools
