#include "tools/studies/baseline/baseline.h"

#include <memory>

#include <CLI/CLI.hpp>

#include "tools/cli/verbs.h"
#include "tools/run/frame/job_options.h"

namespace tools {
namespace {

using Options = BaselineOptions;

CLI::App* add_step(CLI::App& verb, const char* name, const char* what, const std::shared_ptr<Options>& options,
                   int& exit, int (*run)(const Options&)) {
  CLI::App* step = verb.add_subcommand(name, what);
  step->add_option("suite", options->suite, "the suite, a YAML file (docs/compare.md)")->required();
  step->add_option("-j,--jobs", options->jobs, "runs at once; by default as many as the host has threads")
      ->check(CLI::Range(1, 1024));
  step->add_option("--replicates", options->replicates,
                   "play each run so many times, slightly perturbed: a figure that noise moves has moved if it did so\n"
                   "beyond it (docs/noise.md)")
      ->check(CLI::Range(1U, kMostReplicates))
      ->capture_default_str();
  step->callback([=, &exit] { exit = run(*options); });
  return step;
}

}  // namespace

void add_baseline(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("baseline", "Stored figures of small runs, and whether they have moved");
  verb->require_subcommand(1);
  const auto options = std::make_shared<Options>();
  CLI::App* step = add_step(*verb, "record", "Compute a suite and store its values", options, exit, record_baseline);
  step->add_flag("--force", options->force, "replace stored values unseen");
  step->footer("Example: raywatt baseline record tests/baseline/suite.yaml");
  step = add_step(*verb, "check", "Compute a suite and say what is not as stored, and in which unit", options, exit,
                  check_baseline);
  step->add_option("--junit", options->junit,
                   "also write the result as JUnit XML into this file: a new one, or one of an earlier check");
  step->add_flag("--force", options->force, "replace whatever file has that name");
  step->footer(
      "Example: raywatt baseline check tests/baseline/suite.yaml --junit baseline.xml\n"
      "Exit 0: nothing moved; 1: something did; 2: stored values are of other inputs, or there are none.");
  step = add_step(*verb, "accept", "Show what is not as stored, and store it", options, exit, accept_baseline);
  step->footer("Example: raywatt baseline accept tests/baseline/suite.yaml");
  verb->footer("Example: raywatt baseline check tests/baseline/suite.yaml");
}

}  // namespace tools
