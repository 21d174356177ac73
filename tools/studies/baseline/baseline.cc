#include "tools/studies/baseline/baseline.h"

#include <algorithm>

#include <fmt/format.h>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/exit_code.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/run_job.h"
#include "tools/studies/baseline/check.h"
#include "traces/accel/embree_tracer.h"

namespace tools {
namespace {

constexpr std::size_t kLongestLine = 400;

/// Prints text to the terminal. Names of runs come from the user and are made printable by the caller.
void print_to_terminal(const std::string& text) { fmt::print("{}", terminal_text(text)); }
void print_check_line(const RunCheck& run) {
  print_to_terminal(sim::printable(check_line(run), kLongestLine) + "\n");
  std::fflush(stdout);
}

bool has_failed(const RunCheck& run) { return !run.error.empty(); }
bool is_refused(const RunCheck& run) { return !run.refused.empty(); }
bool has_moved(const RunCheck& run) { return !has_failed(run) && !is_refused(run) && !run.moved.empty(); }

/// Returns the stored runs that are no longer in the suite.
std::vector<std::string> removed_runs(const Suite& suite, const Baseline& stored) {
  std::vector<std::string> out;
  for (const auto& [name, run] : stored.runs) {
    if (std::ranges::find(suite.runs, name, &SuiteRun::name) == suite.runs.end()) out.push_back(name);
  }
  return out;
}

Suite suite_of(const BaselineOptions& options) {
  Suite suite = load_suite(options.suite);
  for (SuiteRun& run : suite.runs) run.options.replicates = options.replicates;
  return suite;
}

Checked measure_suite(const Suite& suite, const Baseline* stored, const BaselineOptions& options) {
  return check_suite(suite, stored, host_threads(options.jobs), print_check_line);
}

/// Stores the measured values, unless a run failed.
int store_values(const Suite& suite, const Checked& checked) {
  if (const std::size_t failed = checked.count_if(has_failed); failed != 0) {
    print_to_terminal(fmt::format("\n{} of {} runs failed; nothing is stored\n", failed, checked.runs.size()));
    return kCheckFailed;
  }
  std::size_t values = 0;
  for (const auto& [name, run] : checked.now.runs) values += run.values.size();
  sim::write_file_atomically(suite.values, baseline_text(checked.now, suite));
  print_to_terminal(fmt::format("\n{} values of {} runs: {}\n", values, checked.runs.size(), suite.values.string()));
  return kGood;
}

void check_values_file(const Suite& suite, bool force) {
  sim::check_output(suite.values,
                    {.mark = "schema: raywatt-baseline/1", .kind = "file of stored values", .any = force});
}

Baseline load_stored_values(const Suite& suite) {
  std::error_code failed;
  if (!std::filesystem::exists(suite.values, failed)) {
    throw sim::InputError(fmt::format("{}: no stored values; make them with 'raywatt baseline record {}'",
                                      suite.values.string(), suite.file.string()));
  }
  return load_baseline(suite.values);
}

}  // namespace

int record_baseline(const BaselineOptions& options) {
  const Suite suite = suite_of(options);
  check_values_file(suite, options.force);
  std::error_code failed;
  if (!options.force && std::filesystem::exists(suite.values, failed)) {
    throw sim::InputError(
        fmt::format("{}: values exist already; 'raywatt baseline accept' shows what moved and stores the "
                    "new values, --force replaces them without a check",
                    suite.values.string()));
  }
  return store_values(suite, measure_suite(suite, nullptr, options));
}

int check_baseline(const BaselineOptions& options) {
  const Suite suite = suite_of(options);
  if (!options.junit.empty()) check_junit(options.junit, options.force);
  const Baseline stored = load_stored_values(suite);
  const std::string again = "store new values with 'raywatt baseline accept'";
  if (const std::vector<std::string> names = removed_runs(suite, stored); !names.empty()) {
    throw sim::InputError(fmt::format("{}: has the run '{}', which is no longer in the suite; {}",
                                      suite.values.string(), names.front(), again));
  }
  const Checked checked = measure_suite(suite, &stored, options);
  print_to_terminal(check_details(checked));
  if (!options.junit.empty()) write_junit(options.junit, suite, checked);
  const std::size_t refused = checked.count_if(is_refused), failed = checked.count_if(has_failed),
                    moved = checked.count_if(has_moved);
  if (moved + failed != 0) {
    print_to_terminal(fmt::format("\n{} of {} runs moved{}\n", moved, checked.runs.size(),
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

int accept_baseline(const BaselineOptions& options) {
  const Suite suite = suite_of(options);
  check_values_file(suite, true);  // load_baseline() checks the contents
  const Baseline stored = load_stored_values(suite);
  if (stored.embree != traces::embree_version()) {
    print_to_terminal(
        fmt::format("stored with Embree {}, this program has {}\n", stored.embree, traces::embree_version()));
  }
  for (const std::string& name : removed_runs(suite, stored)) {
    print_to_terminal(sim::printable(fmt::format("GONE     {}", name), kLongestLine) + "\n");
  }
  const Checked checked = measure_suite(suite, &stored, options);
  print_to_terminal(check_details(checked));
  return store_values(suite, checked);
}

}  // namespace tools
