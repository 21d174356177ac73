#include <algorithm>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/cli/verbs.h"
#include "tools/simulation/run_job.h"
#include "tools/studies/baseline/check.h"
#include "tools/studies/baseline/junit.h"
#include "traces/accel/embree_tracer.h"

namespace tools {

namespace {

struct Options {
  std::string suite;
  std::uint32_t jobs = 0;
  std::string junit;
  bool force = false;
};

constexpr std::size_t kLongestLine = 400;

/// Lines for the terminal: names of runs are the user's, and may hold anything.
void print(const std::string& text) { fmt::print("{}", text); }
void tell(const RunCheck& run) {
  print(sim::printable(check_line(run), kLongestLine) + "\n");
  std::fflush(stdout);
}

bool has_failed(const RunCheck& run) { return !run.error.empty(); }
bool is_refused(const RunCheck& run) { return !run.refused.empty(); }
bool has_moved(const RunCheck& run) { return !has_failed(run) && !is_refused(run) && !run.moved.empty(); }

/// Runs that are stored, but no longer in the suite.
std::vector<std::string> gone(const Suite& suite, const Baseline& stored) {
  std::vector<std::string> out;
  for (const auto& [name, run] : stored.runs) {
    if (std::ranges::find(suite.runs, name, &SuiteRun::name) == suite.runs.end()) out.push_back(name);
  }
  return out;
}

Checked measured(const Suite& suite, const Baseline* stored, const Options& options) {
  return check_suite(suite, stored, host_threads(options.jobs), tell);
}

/// Stores what has been measured; a suite of which a run has failed is not stored.
int store(const Suite& suite, const Checked& checked) {
  if (const std::size_t failed = checked.count(has_failed); failed != 0) {
    print(fmt::format("\n{} of {} runs failed; nothing is stored\n", failed, checked.runs.size()));
    return kCheckFailed;
  }
  std::size_t values = 0;
  for (const auto& [name, run] : checked.now.runs) values += run.values.size();
  sim::write_file_atomically(suite.values, baseline_text(checked.now, suite));
  print(fmt::format("\n{} values of {} runs: {}\n", values, checked.runs.size(), suite.values.string()));
  return kGood;
}

int record(const Options& options) {
  const Suite suite = load_suite(options.suite);
  if (!options.force && std::filesystem::exists(suite.values)) {
    throw sim::InputError(
        fmt::format("{}: there are values already; 'raywatt baseline accept' shows what has moved and "
                    "takes the new ones, --force replaces them unseen",
                    suite.values.string()));
  }
  return store(suite, measured(suite, nullptr, options));
}

Baseline stored_values(const Suite& suite) {
  if (!std::filesystem::exists(suite.values)) {
    throw sim::InputError(fmt::format("{}: no stored values; make them with 'raywatt baseline record {}'",
                                      suite.values.string(), suite.file.string()));
  }
  return load_baseline(suite.values);
}

int check(const Options& options) {
  const Suite suite = load_suite(options.suite);
  const Baseline stored = stored_values(suite);
  const std::string again = "take new values with 'raywatt baseline accept'";
  if (stored.embree != traces::embree_version()) {
    throw sim::InputError(fmt::format("{}: stored with Embree {}, this program has {}, which may build other trees; {}",
                                      suite.values.string(), stored.embree, traces::embree_version(), again));
  }
  if (const std::vector<std::string> names = gone(suite, stored); !names.empty()) {
    throw sim::InputError(fmt::format("{}: has the run '{}', which is no longer in the suite; {}",
                                      suite.values.string(), names.front(), again));
  }
  const Checked checked = measured(suite, &stored, options);
  print(check_details(checked));
  if (!options.junit.empty()) write_junit(options.junit, suite, checked);
  const std::size_t refused = checked.count(is_refused), failed = checked.count(has_failed),
                    moved = checked.count(has_moved);
  if (moved + failed != 0) {
    print(fmt::format("\n{} of {} runs moved{}\n", moved, checked.runs.size(),
                      failed != 0 ? fmt::format(", {} failed", failed) : ""));
  }
  if (refused != 0) {
    std::fflush(stdout);
    const auto first = std::ranges::find_if(checked.runs, is_refused);
    throw sim::InputError(fmt::format("{}: {} of {} runs cannot be checked, first '{}': {}; {}", suite.values.string(),
                                      refused, checked.runs.size(), first->name, first->refused.front(), again));
  }
  return moved + failed == 0 ? kGood : kCheckFailed;
}

int accept(const Options& options) {
  const Suite suite = load_suite(options.suite);
  const Baseline stored = stored_values(suite);
  if (stored.embree != traces::embree_version()) {
    print(fmt::format("stored with Embree {}, this program has {}\n", stored.embree, traces::embree_version()));
  }
  for (const std::string& name : gone(suite, stored)) {
    print(sim::printable(fmt::format("GONE     {}", name), kLongestLine) + "\n");
  }
  const Checked checked = measured(suite, &stored, options);
  print(check_details(checked));
  return store(suite, checked);
}

CLI::App* add_step(CLI::App& verb, const char* name, const char* what, const std::shared_ptr<Options>& options,
                   int& exit, int (*run)(const Options&)) {
  CLI::App* step = verb.add_subcommand(name, what);
  step->add_option("suite", options->suite, "the suite, a YAML file (docs/compare.md)")->required();
  step->add_option("-j,--jobs", options->jobs, "runs at once; by default as many as the host has threads")
      ->check(CLI::Range(1, 1024));
  step->callback([=, &exit] { exit = run(*options); });
  return step;
}

}  // namespace

void add_baseline(CLI::App& app, int& exit) {
  CLI::App* verb = app.add_subcommand("baseline", "Stored figures of small runs, and whether they have moved");
  verb->require_subcommand(1);
  const auto options = std::make_shared<Options>();
  CLI::App* step = add_step(*verb, "record", "Compute a suite and store its values", options, exit, record);
  step->add_flag("--force", options->force, "replace stored values unseen");
  step->footer("Example: raywatt baseline record tests/baseline/suite.yaml");
  step = add_step(*verb, "check", "Compute a suite and say what is not as stored, and in which unit", options, exit,
                  check);
  step->add_option("--junit", options->junit, "also write the result as JUnit XML into this file");
  step->footer(
      "Example: raywatt baseline check tests/baseline/suite.yaml --junit baseline.xml\n"
      "Exit 0: nothing moved; 1: something did; 2: stored values are of other inputs, or there are none.");
  step = add_step(*verb, "accept", "Show what is not as stored, and store it", options, exit, accept);
  step->footer("Example: raywatt baseline accept tests/baseline/suite.yaml");
}

}  // namespace tools
