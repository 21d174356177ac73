#include "tools/studies/baseline/baseline.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "sim/error.h"
#include "sim/io/file.h"
#include "sim/io/printable.h"
#include "tools/host/process.h"
#include "tools/host/standard_streams.h"
#include "tools/run/frame/run_job.h"
#include "tools/studies/baseline/check.h"
#include "traces/accel/embree_tracer.h"

namespace tools {
namespace {

/// Returns the first changed value of a run whose path begins with `path`, or null.
const Moved* find_changed_value(const RunCheck& run, std::string_view path) {
  const auto found = std::ranges::find_if(run.moved, [&](const Moved& m) { return m.path.starts_with(path); });
  return found == run.moved.end() ? nullptr : &*found;
}

/// Returns the changed value to print for a run with an unchanged cycle count, if possible one of the whole machine.
const Moved& value_to_print(const RunCheck& run) {
  auto found = std::ranges::find_if(run.moved, [](const Moved& m) { return !m.path.starts_with("units."); });
  if (found == run.moved.end() && run.can_report_changed_unit()) {
    const std::string prefix = fmt::format("units.{}.", run.located->unit);
    found = std::ranges::find_if(run.moved, [&](const Moved& m) { return m.path.starts_with(prefix); });
  }
  return found == run.moved.end() ? run.moved.front() : *found;
}

/// Formats integers exactly and other numbers with six digits, so that small differences are visible.
std::string number_text(double number) {
  return number == std::trunc(number) && std::abs(number) < 1e15 ? fmt::format("{:.0f}", number)
                                                                 : fmt::format("{:.6g}", number);
}

/// Describes the change of a stored value: "100 -> 104 (+4, +4.0 %)".
std::string moved_text(const Moved& moved) {
  if (!moved.was) return fmt::format("{}, not stored", number_text(*moved.is));
  if (!moved.is) return fmt::format("was {}, is missing", number_text(*moved.was));
  const double difference = *moved.is - *moved.was;
  const std::string relative =
      *moved.was == 0 ? "" : fmt::format(", {:+.2g} %", 100 * difference / std::abs(*moved.was));
  const std::string noise = !moved.noise || *moved.was == 0
                                ? ""
                                : fmt::format(", noise ± {:.2g} %", 100 * *moved.noise / std::abs(*moved.was));
  return fmt::format("{} -> {} ({:+.4g}{}{})", number_text(*moved.was), number_text(*moved.is), difference, relative,
                     noise);
}

/// Describes the hardware unit to which a run's change is attributed: "most likely in l2.bank: why.lookup 1921 -> 2364
/// cycles (+443)".
std::string located_text(const RunCheck& run) {
  const LocatedRegression& located = *run.located;
  if (!run.keys.changed.empty()) return fmt::format("moved most in {}: {}", located.unit, located.moved);
  return fmt::format("{} in {}: {}", located.is_certain() ? "most likely" : "perhaps", located.unit, located.moved);
}

/// Returns one line with the first changed configuration key and the number of other changed keys.
std::string first_changed_key_text(const std::vector<KeyPair>& keys) {
  const std::string line = changed_keys_text(std::vector{keys.front()});
  return fmt::format("{}{}\n", line.substr(0, line.find('\n')),
                     keys.size() > 1 ? fmt::format(", and {} more keys", keys.size() - 1) : "");
}

std::string run_details(const RunCheck& run) {
  constexpr std::size_t kMost = 6;
  if (!run.error.empty()) return fmt::format("\n{}: {}\n", run.name, run.error);
  std::string out = fmt::format("\n{}\n", run.name);
  for (const std::string& why : run.refused) out += fmt::format("  {}\n", why);
  if (!run.keys.changed.empty()) out += "  " + first_changed_key_text(run.keys.changed);
  std::size_t shown = 0;
  const auto show = [&](bool of_units, std::string_view prefix) {
    for (const Moved& moved : run.moved) {
      if (moved.path.starts_with("units.") != of_units || !moved.path.starts_with(prefix)) continue;
      if (shown == kMost) return;
      out += fmt::format("  {}: {}\n", moved.path, moved_text(moved));
      shown += 1;
    }
  };
  show(false, "");
  const std::size_t figures = std::exchange(shown, 0);
  const std::string own = run.can_report_changed_unit() ? fmt::format("units.{}.", run.located->unit) : "units.";
  show(true, find_changed_value(run, own) != nullptr ? own : "units.");
  if (figures + shown < run.moved.size()) {
    out += fmt::format("  and {} more values\n", run.moved.size() - figures - shown);
  }
  if (run.can_report_changed_unit()) out += fmt::format("  {}\n", located_text(run));
  return out;
}

/// Returns the configuration keys that changed in at least one run, with old and new value, without duplicates.
std::vector<KeyPair> differing_keys(const SuiteCheck& checked, std::vector<KeyPair> ChangedKeys::*of) {
  std::vector<KeyPair> out;
  for (const RunCheck& run : checked.runs) {
    for (const KeyPair& key : run.keys.*of) {
      const auto is_same = [&](const KeyPair& k) { return k.key == key.key && k.a == key.a && k.b == key.b; };
      if (std::ranges::none_of(out, is_same)) out.push_back(key);
    }
  }
  return out;
}

/// Returns the run whose change is attributed to a hardware unit with the highest certainty; null if there is none.
const RunCheck* most_certain_run(const SuiteCheck& checked) {
  const RunCheck* best = nullptr;
  for (const RunCheck& run : checked.runs) {
    if (run.located && (best == nullptr || run.located->certainty > best->located->certainty)) best = &run;
  }
  return best;
}

/// Returns the output line of a run: "ok teapot", "MOVED teapot: 12 of 300 values, cycles 100 -> 104 (+4.0 %)".
std::string check_line(const RunCheck& run) {
  if (!run.error.empty()) return fmt::format("FAILED   {}: {}", run.name, run.error.substr(0, run.error.find('\n')));
  if (!run.refused.empty()) return fmt::format("REFUSED  {}: {}", run.name, run.refused.front());
  if (run.moved.empty()) return fmt::format("ok       {}", run.name);
  const Moved* cycles = find_changed_value(run, "totals.cycles");
  const Moved& shown = cycles != nullptr ? *cycles : value_to_print(run);
  return fmt::format("MOVED    {}: {} of {} values, {} {}", run.name, run.moved.size(), run.values, shown.path,
                     moved_text(shown));
}

/// Describes the runs that failed or changed: changed configuration keys, changed values, most likely hardware unit.
std::string check_details(const SuiteCheck& checked) {
  constexpr std::size_t kMost = 6;
  std::vector<const RunCheck*> bad;
  for (const RunCheck& run : checked.runs) {
    if (!run.is_good()) bad.push_back(&run);
  }
  std::ranges::stable_sort(bad, std::greater<>(), [](const RunCheck* run) {
    return !run->error.empty() || !run->refused.empty() ? 2 : run->located ? run->located->certainty : 0;
  });
  std::string out;
  for (std::size_t i = 0; i < std::min(bad.size(), kMost); ++i) out += run_details(*bad[i]);
  if (bad.size() > kMost) out += fmt::format("\nand {} more runs; --junit writes all\n", bad.size() - kMost);
  // Changed keys are facts, so they are printed before units estimated from counters.
  const std::vector<KeyPair> changed = differing_keys(checked, &ChangedKeys::changed);
  if (!changed.empty()) out += "\n" + changed_keys_text(changed);
  if (const RunCheck* run = most_certain_run(checked); run != nullptr) {
    std::string text = located_text(*run);
    text.front() = static_cast<char>(std::toupper(text.front()));
    out += fmt::format("{}{}, most clearly in run {}\n", changed.empty() ? "\n" : "", text, run->name);
  } else if (!changed.empty() && bad.empty()) {
    out += "No kept value has moved.\n";
  }
  const std::vector<KeyPair> of_one = differing_keys(checked, &ChangedKeys::of_one);
  if (!of_one.empty()) out += "\nKeys of only one of the two configurations:\n" + changed_keys_text(of_one);
  return out;
}

constexpr std::size_t kLongest = 1000;

/// Returns text without what XML does not allow: control characters and invalid UTF-8.
std::string xml_text(const std::string& text) { return sim::printable(text, kLongest); }

/// Returns the failure message of a run for a JUnit file.
std::string failure_text(const RunCheck& run) {
  std::string out;
  std::istringstream error(run.error);
  for (std::string line; std::getline(error, line);) out += xml_text(line) + "\n";
  for (const std::string& why : run.refused) out += xml_text(why) + "\n";
  std::istringstream keys(changed_keys_text(run.keys.changed) + changed_keys_text(run.keys.of_one));
  for (std::string line; std::getline(keys, line);) out += xml_text(line) + "\n";
  if (run.can_report_changed_unit()) out += xml_text(located_text(run)) + "\n";
  for (const Moved& moved : run.moved) out += xml_text(fmt::format("{}: {}", moved.path, moved_text(moved))) + "\n";
  return out;
}

constexpr const char* kMadeBy = " made by raywatt baseline check ";

/// Throws InputError if the JUnit file may not be replaced, because `raywatt baseline` did not write it. With `force`
/// any regular file may be replaced.
void check_junit(const std::filesystem::path& file, bool force) {
  sim::check_output(file, {.mark = kMadeBy, .kind = "JUnit file of this verb", .any = force});
}

/// Writes the results of a suite as JUnit XML for continuous integration, one test case per run.
void write_junit(const std::filesystem::path& file, const Suite& suite, const SuiteCheck& checked) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  document.append_child(pugi::node_comment).set_value(kMadeBy);
  pugi::xml_node root = document.append_child("testsuite");
  std::size_t failures = 0, errors = 0;
  double seconds = 0;
  for (const RunCheck& run : checked.runs) {
    const bool is_error = !run.error.empty() || !run.refused.empty();
    errors += is_error ? 1 : 0;
    failures += !is_error && !run.moved.empty() ? 1 : 0;
    seconds += run.seconds;
  }
  root.append_attribute("name") = xml_text(suite.suite_name()).c_str();
  root.append_attribute("tests") = checked.runs.size();
  root.append_attribute("failures") = failures;
  root.append_attribute("errors") = errors;
  root.append_attribute("time") = fmt::format("{:.3f}", seconds).c_str();
  for (const RunCheck& run : checked.runs) {
    pugi::xml_node test = root.append_child("testcase");
    test.append_attribute("classname") = xml_text(suite.suite_name()).c_str();
    test.append_attribute("name") = xml_text(run.name).c_str();
    test.append_attribute("time") = fmt::format("{:.3f}", run.seconds).c_str();
    if (run.is_good()) continue;
    pugi::xml_node problem = test.append_child(run.error.empty() && run.refused.empty() ? "failure" : "error");
    problem.append_attribute("message") = xml_text(check_line(run)).c_str();
    problem.append_attribute("type") = !run.error.empty() ? "failed" : !run.refused.empty() ? "refused" : "moved";
    problem.append_child(pugi::node_pcdata).set_value(failure_text(run).c_str());
  }
  std::ostringstream text;
  document.save(text, "  ");
  sim::write_file_atomically(file, text.str());
}

constexpr std::size_t kLongestLine = 400;

/// Prints text to the terminal. The caller must have removed control characters from names of runs.
void print_to_terminal(const std::string& text) { fmt::print("{}", to_terminal_encoding(text)); }
void print_check_line(const RunCheck& run) {
  print_to_terminal(sim::printable(check_line(run), kLongestLine) + "\n");
  std::fflush(stdout);
}

bool has_failed(const RunCheck& run) { return !run.error.empty(); }
bool is_refused(const RunCheck& run) { return !run.refused.empty(); }
bool has_changed_value(const RunCheck& run) { return !has_failed(run) && !is_refused(run) && !run.moved.empty(); }

/// Returns names of runs that have stored values but are no longer in the suite.
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

SuiteCheck measure_suite(const Suite& suite, const Baseline* stored, const BaselineOptions& options) {
  return check_suite(suite, stored, host_threads(options.jobs), print_check_line);
}

/// Writes the measured values to the file of stored values, unless a run failed.
int store_values(const Suite& suite, const SuiteCheck& checked) {
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
  const SuiteCheck checked = measure_suite(suite, &stored, options);
  print_to_terminal(check_details(checked));
  if (!options.junit.empty()) write_junit(options.junit, suite, checked);
  const std::size_t refused = checked.count_if(is_refused), failed = checked.count_if(has_failed),
                    moved = checked.count_if(has_changed_value);
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
  const SuiteCheck checked = measure_suite(suite, &stored, options);
  print_to_terminal(check_details(checked));
  return store_values(suite, checked);
}

}  // namespace tools
