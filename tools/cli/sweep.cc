#include "tools/studies/sweep/sweep.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/job_options.h"
#include "tools/cli/verbs.h"
#include "tools/host/paths.h"

namespace tools {
namespace {

namespace fs = std::filesystem;

void add_sweep_run(CLI::App& group, int& exit) {
  CLI::App* verb =
      group.add_subcommand("run", "Compute all points of a sweep; those that are there are not computed again");
  const auto options = std::make_shared<SweepOptions>();
  verb->add_option("file", options->file,
                   "the sweep: an experiment's name such as trv-cores, or a .yaml file (docs/sweeps.md)");
  verb->add_option("-o,--output", options->out, "folder of the sweep (default: raywatt-out/sweep-NAME)");
  verb->add_option("--store", options->store,
                   "folder of results, for any number of sweeps (default: $RAYWATT_STORE, else raywatt-out/store)");
  add_launcher_options(*verb, *options);
  verb->add_flag("--wait", options->wait, "slurm: return when all points have ended");
  verb->add_flag("--resume", options->resume, "go on with the sweep in the folder; then FILE may be left out");
  verb->add_flag("--dry-run", options->dry_run, "list the points; compute nothing, write nothing");
  verb->add_flag("--quiet", options->quiet, "no summary, no bar");
  add_progress_option(*verb, options->progress);
  verb->footer(
      "The same command again goes on where it was stopped. Ends with 1, and a list, if points failed.\n\n"
      "Example: raywatt sweep run trv-cores -o out/trv-cores -j 4");
  verb->callback([options, &exit] {
    if (!options->file.empty()) options->file = find_experiment(options->file);
    exit = run_sweep(*options);
  });
}

void add_sweep_point(CLI::App& group, int& exit) {
  CLI::App* verb =
      group.add_subcommand("point", "Compute some points of a sweep: what launchers start on cluster nodes");
  const auto options = std::make_shared<PointOptions>();
  verb->add_option("folder", options->folder, "the sweep's folder")->required();
  verb->add_option("--list", options->list, "a file of ids, one or more a line (default: all points of the sweep)");
  refuse_negative(*verb->add_option("--index", options->index, "which chunk of its lines, from 0")->required());
  verb->add_option("-j,--jobs", options->jobs, "points at a time")->check(CLI::Range(1, 1024))->capture_default_str();
  verb->add_option("--chunk", options->chunk, "lines of a chunk")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  verb->add_flag("--retry-failed", options->retry_failed, "points that failed are computed again");
  verb->footer(
      "Ends with 0 at once if the results are there, with 1 if a point fails.\n\n"
      "Example: raywatt sweep point out/l1 --list out/l1/submit-1.txt --index 7 --chunk 4");
  verb->callback([options, &exit] { exit = compute_points(*options); });
}

void add_sweep_status(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("status", "How far a sweep is");
  const auto path = std::make_shared<fs::path>();
  const auto json = std::make_shared<bool>(false);
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->add_flag("--json", *json, "as JSON");
  verb->footer("Example: raywatt sweep status out/l1");
  verb->callback([=] { print_sweep_status(*path, *json); });
}

void add_sweep_watch(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("watch", "Show how far a sweep is until its points have ended");
  const auto path = std::make_shared<fs::path>();
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->footer(
      "Looks at the folder and its store alone, once a second. A line every two seconds where standard output is no\n"
      "terminal.\n\nExample: raywatt sweep watch out/l1");
  verb->callback([=] { watch_sweep(*path); });
}

void add_sweep_cancel(CLI::App& group) {
  CLI::App* verb = group.add_subcommand("cancel", "Stop whoever runs a sweep, and its jobs; what is finished is kept");
  const auto path = std::make_shared<fs::path>();
  verb->add_option("folder", *path, "the sweep's folder")->required();
  verb->footer("Example: raywatt sweep cancel out/l1");
  verb->callback([=] { cancel_sweep(*path); });
}

}  // namespace

void add_sweep(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("sweep", "Many runs: axes, conditions, subsets; nothing is computed twice");
  verb->require_subcommand(1);
  verb->footer("Example: raywatt sweep run trv-cores -o out/trv-cores");
  add_sweep_run(*verb, exit);
  add_sweep_point(*verb, exit);
  add_sweep_status(*verb);
  add_sweep_watch(*verb);
  add_sweep_cancel(*verb);
  add_sweep_results(*verb);
}

}  // namespace tools
