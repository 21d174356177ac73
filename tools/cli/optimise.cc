#include "tools/studies/optimise/optimise.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"
#include "tools/studies/optimise/task.h"

namespace tools {

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
