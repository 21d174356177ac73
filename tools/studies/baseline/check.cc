#include "tools/studies/baseline/check.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>

#include "hw_models/machines/unit_kinds.h"
#include "sim/config/config.h"
#include "sim/edit_distance.h"
#include "sim/error.h"
#include "sim/host_clock.h"
#include "sim/io/json.h"
#include "sim/io/printable.h"
#include "tools/analysis/report_file.h"
#include "tools/analysis/units.h"
#include "tools/host/process.h"
#include "tools/run/frame/load_config.h"
#include "tools/run/run.h"
#include "traces/accel/embree_tracer.h"

namespace tools {
namespace {

using sim::Json;

/// The measured result of one run of a suite.
struct Measured {
  RunInputs facts;
  Values all;          ///< all numbers of the run's report, except those of replicates
  StoredDraws draws;   ///< statistics over replicates; empty without replicates
  std::string error;   ///< reason that there is no report; empty if there is one
  double seconds = 0;  ///< host time of the run in seconds
};

/// Simulates a run and returns its report. After an error returns {"error": text, "is_input": whether the user can fix
/// it}. Throws only std::bad_alloc.
Json report_or_error(const JobOptions& options) {
  try {
    return plain_report(load_inputs(options), options);
  } catch (const sim::Deadlock& error) {
    return {{"error", fmt::format("{}\n{}", error.what(), error.state)}, {"is_input", false}};
  } catch (const sim::InputError& error) {
    return {{"error", error.what()}, {"is_input", true}};
  } catch (const std::bad_alloc&) {  // the host is short of memory; the run itself is not wrong
    throw;
  } catch (const std::exception& error) {
    return {{"error", error.what()}, {"is_input", false}};
  }
}

/// Returns the statistics over replicates by report path, such as totals.cycles.
StoredDraws draws_of_replicates(const Json& replicates) {
  StoredDraws out;
  const auto count = replicates["count"].get<std::size_t>();
  constexpr std::string_view kMean = "/mean";
  const Json& figures = replicates["figures"];
  const Json flat = figures.flatten();
  for (const auto& [pointer, mean] : flat.items()) {
    if (!pointer.ends_with(kMean)) continue;
    const std::string at = pointer.substr(0, pointer.size() - kMean.size());
    std::string path = "totals" + at;
    std::ranges::replace(path, '/', '.');
    out[path] = {count, mean.get<double>(), figures.at(sim::JsonPointer(at + "/deviation")).get<double>()};
  }
  return out;
}

Measured measured_from(const SuiteRun& run, const std::string& text, int status, double seconds) {
  Measured out;
  out.seconds = seconds;
  if (WIFSIGNALED(status)) {
    out.error = fmt::format("ended by signal {}", WTERMSIG(status));
    return out;
  }
  Json report;
  try {
    report = sim::parse_json(text);
  } catch (const sim::JsonError&) {  // the child process ended before its report was complete
  }
  if (WEXITSTATUS(status) == kIoFailed) throw std::bad_alloc();
  if (!report.is_object()) {
    out.error = fmt::format("ended with {} before its report", WEXITSTATUS(status));
  } else if (report.contains("error")) {
    out.error = report["error"].get<std::string>();
    if (report["is_input"].get<bool>()) throw sim::InputError(fmt::format("runs.{}: {}", run.name, out.error));
  } else {
    out.facts = {report["program"].get<std::string>(), report["provenance"]["scene_sha256"].get<std::string>(),
                 report["provenance"]["bvh_hash"].get<std::string>(), flat_config(report["config"])};
    out.facts.config.erase("scene.name");
    for (ReportNumber& number : report_numbers(report)) {
      if (number.path.find(".replicates.") == std::string::npos) out.all.emplace(std::move(number.path), number.value);
    }
    if (run.options.replicates > 1) out.draws = draws_of_replicates(report["totals"]["replicates"]);
  }
  return out;
}

/// A run that is being simulated in a child process.
struct Worker {
  std::size_t run = 0;  ///< index in the suite
  sim::HostClock::time_point begin = sim::HostClock::now();
  std::unique_ptr<ChildProcess> child;
};

std::unique_ptr<ChildProcess> start_run(const SuiteRun& run) {
  return std::make_unique<ChildProcess>([&] {
    try {
      return sim::json_line(report_or_error(run.options));
    } catch (const std::bad_alloc&) {
      std::_Exit(kIoFailed);
    }
  });
}

/// Simulates the runs of a suite in child processes, `jobs` at once, and calls `take` with each run and its result, in
/// the suite's order. Throws InputError if a run cannot start, e.g. because of a broken scene file.
void simulate_suite(const Suite& suite, std::uint32_t jobs,
                    const std::function<void(const SuiteRun&, Measured)>& take) {
  std::vector<std::optional<Measured>> done(suite.runs.size());
  std::vector<Worker> workers;
  std::size_t next = 0, taken = 0;
  while (taken < suite.runs.size()) {
    for (; workers.size() < jobs && next < suite.runs.size(); ++next) {
      workers.push_back({.run = next, .child = start_run(suite.runs[next])});
    }
    std::vector<pollfd> ends;
    for (const Worker& worker : workers) ends.push_back({worker.child->pipe_end(), POLLIN, 0});
    if (::poll(ends.data(), ends.size(), -1) < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "poll");
    }
    for (std::size_t i = workers.size(); i-- > 0;) {
      const auto& [run, begin, child] = workers[i];
      if (ends[i].revents == 0 || child->receive_data()) continue;
      const int status = child->wait_for_exit();
      done[run] = measured_from(suite.runs[run], child->received_text(), status, sim::seconds_since(begin));
      workers.erase(workers.begin() + static_cast<std::ptrdiff_t>(i));
    }
    for (; taken < done.size() && done[taken]; ++taken) take(suite.runs[taken], *std::move(done[taken]));
  }
}

/// Returns one short trial run for each combination of program and reference in a suite. Trial runs render 16x16 pixels
/// of a built-in scene and show which report paths exist.
Suite trial_runs_of(const Suite& suite) {
  Suite probes;
  for (const SuiteRun& run : suite.runs) {
    const auto is_like = [&](const SuiteRun& other) {
      return other.options.program == run.options.program && other.options.reference == run.options.reference;
    };
    if (std::ranges::any_of(probes.runs, is_like)) continue;
    SuiteRun probe = run;
    probe.options.scene = "cornell";
    probe.options.camera = probe.options.frames = "";
    probe.options.resolution = "16x16";
    probe.options.replicates = 1;
    std::erase_if(probe.options.sets, [](const std::string& set) { return set.starts_with("scene."); });
    probes.runs.push_back(std::move(probe));
  }
  return probes;
}

/// Removes digits from a report path, so that "units.core0.srp" and "units.core3.srp" are equal.
std::string remove_digits(std::string path) {
  std::erase_if(path, [](unsigned char c) { return std::isdigit(c) != 0; });
  return path;
}

/// Returns the end of a report path with as many components as `text` has.
std::string end_of_same_depth(const std::string& path, std::string_view text) {
  std::size_t begin = path.size();
  for (auto parts = std::ranges::count(text, '.') + 1; parts > 0 && begin != std::string::npos; --parts) {
    begin = begin == 0 ? std::string::npos : path.rfind('.', begin - 1);
  }
  return begin == std::string::npos ? path : path.substr(begin + 1);
}

/// Returns the end of a report path that is spelt most like `text`, for an error message; empty if none is similar.
/// Paths that depend on the scene are not considered.
std::string nearest_path_end(const std::string& text, const std::vector<std::string>& paths) {
  constexpr std::string_view kNominal = ".nominal";
  std::set<std::string> known;
  for (const std::string& path : paths) {
    if (path.starts_with("units.") || path.find(".kernels.") != std::string::npos) continue;
    known.insert(end_of_same_depth(path, text));
    if (path.ends_with(kNominal)) known.insert(end_of_same_depth(path.substr(0, path.size() - kNominal.size()), text));
  }
  const std::string_view start = sim::comparison_prefix(text);
  const auto found = sim::find_nearest(start, known, std::max<std::size_t>(1, start.size() / 4));
  return found == known.end() ? std::string() : *found;
}

/// Throws InputError for a misspelt report path in the suite's `keep`, with the most similar path. Simulates short
/// runs.
void check_report_paths(const Suite& suite, std::uint32_t jobs) {
  std::vector<std::string> paths;
  try {
    simulate_suite(trial_runs_of(suite), jobs, [&](const SuiteRun&, const Measured& probe) {
      for (const auto& [path, value] : probe.all) paths.push_back(path);
    });
  } catch (const sim::InputError&) {  // the run of the suite will fail with a better message
    return;
  }
  std::set<std::string> kinds;
  for (const std::string& path : paths) kinds.insert(remove_digits(path));
  const std::vector<std::string> known(kinds.begin(), kinds.end());
  for (const KeepEntry& kept : suite.kept) {
    if (denotes_report_path(remove_digits(kept.text), known)) continue;
    if (const std::string nearest = nearest_path_end(kept.text, paths); !nearest.empty()) {
      throw sim::InputError(fmt::format("{}: keep: there is no report path '{}', did you mean '{}'?", kept.at,
                                        sim::printable(kept.text), nearest));
    }
  }
}

/// Selects the numbers of a report that a suite stores.
class KeptPaths {
 public:
  explicit KeptPaths(const Suite& suite) : suite_(suite) {}

  struct Chosen {
    std::string path;
    double percent = 0;
  };
  /// Returns the report paths that the suite's `keep` selects, in the order of `keep`. A path that is selected twice
  /// has its first position and its last tolerance.
  std::vector<Chosen> select_report_paths(const Values& all) {
    std::vector<std::string> paths;
    for (const auto& [path, value] : all) paths.push_back(path);
    std::vector<Chosen> out;
    std::map<std::string, std::size_t> index_of;
    for (const KeepEntry& kept : suite_.kept) {
      for (std::string& path : paths_of(kept, paths)) {
        found_.insert(kept.text);
        const auto [at, is_new] = index_of.emplace(path, out.size());
        if (is_new) out.push_back({std::move(path), 0});
        out[at->second].percent = kept.percent;
      }
    }
    return out;
  }
  void refuse_absent_paths(const Values& all) const {
    std::vector<std::string> paths;
    for (const auto& [path, value] : all) paths.push_back(path);
    for (const KeepEntry& kept : suite_.kept) {
      if (found_.contains(kept.text)) continue;
      add_place_to_errors(kept, [&] { resolve_report_path(kept.text, paths); });
    }
  }

 private:
  static std::vector<std::string> paths_of(const KeepEntry& kept, const std::vector<std::string>& paths) {
    std::vector<std::string> out;
    add_place_to_errors(kept, [&] { out = report_path_group(kept.text, paths); });
    return out;
  }
  static void add_place_to_errors(const KeepEntry& kept, const std::function<void()>& call) {
    try {
      call();
    } catch (const sim::InputError& error) {
      throw sim::InputError(fmt::format("{}: keep: {}", kept.at, error.what()));
    }
  }
  const Suite& suite_;
  std::set<std::string> found_;
};

/// Returns the configuration keys that change which rays are rendered, not only their timing.
const std::set<std::string>& function_keys() {
  static const std::set<std::string> keys = [] {
    std::set<std::string> out;
    for (const sim::FieldInfo& field : sim::list_fields(RunConfig{})) {
      if (field.affects == sim::Affects::kFunction) out.insert(field.path);
    }
    return out;
  }();
  return keys;
}

/// Removes keys that change which rays are rendered from `keys`, and adds an error message for each to `refusals`.
void refuse_other_work(std::vector<KeyPair>& keys, std::vector<std::string>& refusals) {
  for (const KeyPair& key : keys) {
    if (!function_keys().contains(key.key)) continue;
    refusals.push_back(fmt::format("stored of other work: {} was {}, is {}", key.key, key.a, key.b));
  }
  std::erase_if(keys, [](const KeyPair& key) { return function_keys().contains(key.key); });
}

/// Returns the reasons why new values cannot be compared with stored ones, such as another scene or program. `was`,
/// `is`: inputs of the stored and the new run; `embree`: version that built the stored tree. Adds to `keys` the changed
/// keys that do not prevent a comparison.
std::vector<std::string> find_refusals(const RunInputs& was, const std::string& embree, const RunInputs& is,
                                       ChangedKeys& keys) {
  std::vector<std::string> out;
  if (was.program != is.program) out.push_back(fmt::format("stored of program {}, now {}", was.program, is.program));
  keys = changed_keys(was.config, is.config);
  refuse_other_work(keys.changed, out);
  refuse_other_work(keys.of_one, out);
  if (was.scene_sha256 != is.scene_sha256) out.emplace_back("stored of another scene (scene_sha256 differs)");
  if (out.empty() && was.bvh_hash != is.bvh_hash) {
    std::string causes;
    if (embree != traces::embree_version()) {
      causes += fmt::format("; stored with Embree {}, this program has {}", embree, traces::embree_version());
    }
    for (const std::vector<KeyPair>* list : {&keys.changed, &keys.of_one}) {
      for (const KeyPair& key : *list) {
        if (key.key.starts_with("bvh.")) causes += fmt::format("; {} was {}, is {}", key.key, key.a, key.b);
      }
    }
    out.push_back(fmt::format("stored of another tree: bvh_hash was {:.12}..., is {:.12}...{}", was.bvh_hash,
                              is.bvh_hash, causes));
  }
  return out;
}

/// Returns the hardware unit that most likely changed. Units whose keys changed are tried first.
std::optional<LocatedRegression> locate_in_run(const ChangedKeys& keys, const Values& was, const Values& is) {
  std::optional<LocatedRegression> best;
  for (const KeyPair& key : keys.changed) {
    const auto found = largest_change_in_unit(unit_of_key(key.key), was, is);
    if (found && (!best || found->certainty > best->certainty)) best = found;
  }
  return best ? best : locate_regression(was, is);
}

bool is_within_tolerance(double was, double is, double percent) {
  return was == is || std::abs(is - was) <= percent / 100 * std::abs(was);
}

/// Compares the mean of a value over new replicates with the stored mean. A value stored without replicates counts as
/// one replicate, with the standard deviation of the new ones.
Moved compare_replicates(const std::string& path, const StoredRun& stored, const Draws& now) {
  const auto was = stored.draws.find(path);
  if (was != stored.draws.end()) {
    return {path, was->second.mean, now.mean, difference_of(was->second, now).half_width()};
  }
  const auto plays = static_cast<double>(now.count);
  const MeanDifference d{0, now.deviation * std::sqrt(1 + 1 / plays), plays - 1};
  return {path, stored.values.at(path), now.mean, d.half_width()};
}

void find_changed_value(const StoredRun& stored, const std::vector<KeptPaths::Chosen>& chosen, const Measured& now,
                        RunCheck& run) {
  std::set<std::string> known;
  for (const KeptPaths::Chosen& c : chosen) {
    known.insert(c.path);
    const auto draws = now.draws.find(c.path);
    if (draws != now.draws.end() && stored.values.contains(c.path)) {
      Moved moved = compare_replicates(c.path, stored, draws->second);
      const bool outside = std::abs(*moved.is - *moved.was) > *moved.noise;
      if (outside && !is_within_tolerance(*moved.was, *moved.is, c.percent)) run.moved.push_back(std::move(moved));
      continue;
    }
    const double is = now.all.at(c.path);
    const auto was = stored.values.find(c.path);
    if (was == stored.values.end() && is != 0) {
      run.moved.push_back({c.path, std::nullopt, is, {}});
    } else if (was != stored.values.end() && !is_within_tolerance(was->second, is, c.percent)) {
      run.moved.push_back({c.path, was->second, is, {}});
    }
  }
  for (const auto& [path, was] : stored.values) {
    if (!known.contains(path)) run.moved.push_back({path, was, std::nullopt, {}});
  }
}

}  // namespace

std::size_t SuiteCheck::count_if(bool (*predicate)(const RunCheck&)) const {
  return static_cast<std::size_t>(std::ranges::count_if(runs, predicate));
}

SuiteCheck check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                       const std::function<void(const RunCheck&)>& report) {
  check_report_paths(suite, jobs);
  SuiteCheck out;
  out.now.embree = traces::embree_version();
  KeptPaths kept_paths(suite);
  Values one_of_them;
  simulate_suite(suite, jobs, [&](const SuiteRun& named, Measured measured) {
    RunCheck run;
    run.name = named.name;
    run.seconds = measured.seconds;
    run.error = measured.error;
    if (run.error.empty()) {
      const std::vector<KeptPaths::Chosen> chosen = kept_paths.select_report_paths(measured.all);
      run.values = chosen.size();
      StoredRun& now = out.now.runs[named.name];
      now.facts = measured.facts;
      for (const KeptPaths::Chosen& c : chosen) {
        if (const auto draws = measured.draws.find(c.path); draws != measured.draws.end()) now.draws.insert(*draws);
        if (const double value = measured.all.at(c.path); value != 0) now.values[c.path] = value;
      }
      const auto was = stored != nullptr ? stored->runs.find(named.name) : decltype(stored->runs.find(""))();
      if (stored != nullptr && was == stored->runs.end()) {
        run.refused.emplace_back("it has no stored values");
      } else if (stored != nullptr) {
        run.refused = find_refusals(was->second.facts, stored->embree, measured.facts, run.keys);
        find_changed_value(was->second, chosen, measured, run);
        if (run.refused.empty() && !run.moved.empty())
          run.located = locate_in_run(run.keys, was->second.values, measured.all);
      }
      one_of_them = std::move(measured.all);
    }
    report(run);
    out.runs.push_back(std::move(run));
  });
  if (!one_of_them.empty()) kept_paths.refuse_absent_paths(one_of_them);
  return out;
}

namespace {

/// Returns the configuration group of a kind of unit: "tni.trv" of "core.tni.trv".
std::string_view remove_core_prefix(std::string_view kind) {
  constexpr std::string_view kCore = "core.";
  return kind.starts_with(kCore) ? kind.substr(kCore.size()) : kind;
}

/// Returns the kind of unit that a configuration group configures; empty if there is none, or more than one.
std::string_view kind_of_group(std::string_view group) {
  std::string_view inside;
  std::size_t kinds_inside = 0;
  for (const hw::UnitKind& kind : hw::kUnitKinds) {
    if (remove_core_prefix(kind.name) == group) return kind.name;
    if (!is_part_of(kind.name, group)) continue;
    inside = kind.name;
    kinds_inside += 1;
  }
  return kinds_inside == 1 ? inside : std::string_view();
}

/// Returns the group of a configuration key: "dram.timing" of "dram.timing.rcd". Empty for a key without a group.
std::string_view group_of(std::string_view key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : key.substr(0, dot);
}

}  // namespace

ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is) {
  ChangedKeys out;
  for (const auto& [key, before] : was) {
    const auto after = is.find(key);
    if (after == is.end()) {
      out.of_one.push_back({key, before, "none"});
    } else if (before != after->second) {
      out.changed.push_back({key, before, after->second});
    }
  }
  for (const auto& [key, after] : is) {
    if (!was.contains(key)) out.of_one.push_back({key, "none", after});
  }
  std::ranges::stable_sort(out.of_one, {}, &KeyPair::key);
  return out;
}

std::string unit_of_key(std::string_view key) {
  std::string_view group = key;
  for (std::size_t dot = key.rfind('.'); dot != std::string_view::npos; dot = group.rfind('.')) {
    group = group.substr(0, dot);
    if (const std::string_view kind = kind_of_group(group); !kind.empty()) return std::string(kind);
  }
  return group == key ? std::string() : std::string(group);
}

bool is_part_of(std::string_view kind, std::string_view unit) {
  const std::string_view name = remove_core_prefix(kind);
  return kind == unit || (name.starts_with(unit) && name.size() > unit.size() && name[unit.size()] == '.');
}

std::string changed_key_text(const KeyPair& key) { return fmt::format("{} was {}, is {}", key.key, key.a, key.b); }

std::string changed_keys_text(const std::vector<KeyPair>& keys) {
  constexpr std::ptrdiff_t kMostOfGroup = 4;
  std::vector<std::string> units;
  for (const KeyPair& key : keys) {
    std::string unit = unit_of_key(key.key);
    if (std::ranges::find(units, unit) == units.end()) units.push_back(std::move(unit));
  }
  std::string out;
  for (const std::string& unit : units) {
    std::string_view shown;  // group whose line was printed last
    for (const KeyPair& key : keys) {
      if (unit_of_key(key.key) != unit) continue;
      const std::string_view group = group_of(key.key);
      const auto others = std::ranges::count(keys, group, [](const KeyPair& k) { return group_of(k.key); }) - 1;
      const bool is_many = !group.empty() && others >= kMostOfGroup;
      if (is_many && group == shown) continue;
      shown = group;
      out += fmt::format("Changed{}: {}{}\n", unit.empty() ? "" : " in " + unit, changed_key_text(key),
                         is_many ? fmt::format(", and {} more keys of {}", others, group) : "");
    }
  }
  return out;
}

namespace {

double value_or_zero(const Values& values, const std::string& path) {
  const auto found = values.find(path);
  return found == values.end() ? 0 : found->second;
}

/// Returns the duration of a clock cycle of a kind of unit, in T&I cycles.
double tni_cycles_per_cycle(const Values& values, std::string_view unit) {
  const double elapsed = value_or_zero(values, fmt::format("units.{}.elapsed", unit));
  return elapsed == 0 ? 0 : value_or_zero(values, "totals.cycles") / elapsed;
}

/// Time that units of a kind spent for one cycle reason, in the old and the new run.
struct ReasonTimeChange {
  std::string_view unit;
  std::string reason;
  sim::ReasonKind kind;
  double was = 0, is = 0;  ///< in T&I cycles, averaged over the units
  double difference() const { return is - was; }
};

std::vector<ReasonTimeChange> reason_time_changes(const Values& was, const Values& is) {
  std::vector<ReasonTimeChange> out;
  for (const auto& [unit, declared] : hw::kUnitKinds) {
    const std::string prefix = fmt::format("units.{}.why.", unit);
    std::set<std::string> reasons;
    for (const Values* values : {&was, &is}) {
      for (auto at = values->lower_bound(prefix); at != values->end() && at->first.starts_with(prefix); ++at) {
        reasons.insert(at->first.substr(prefix.size()));
      }
    }
    for (const std::string& reason : reasons) {
      out.push_back({unit, reason, hw::kind_of_reason(unit, reason).value_or(sim::ReasonKind::kWaiting),
                     value_or_zero(was, prefix + reason) * tni_cycles_per_cycle(was, unit),
                     value_or_zero(is, prefix + reason) * tni_cycles_per_cycle(is, unit)});
    }
  }
  return out;
}

/// Returns the sum of a performance counter over all units of a kind.
template <class Unit>
double sum_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return value_or_zero(values, counter_path<Unit>(counter, kind));
}

/// Returns a counter of clock cycles, summed over all units of a kind and converted to T&I cycles.
template <class Unit>
double time_of(const Values& values, std::uint64_t Unit::Stats::*counter, std::string_view kind = Unit::kName) {
  return sum_of<Unit>(values, counter, kind) * tni_cycles_per_cycle(values, kind) *
         value_or_zero(values, fmt::format("units.{}.units", kind));
}

/// Number and total time (T&I cycles) of the cache lines that one memory level requests from the next. Each of both
/// levels counts them.
struct Traffic {
  double requested = 0, served = 0;
  double request_time = 0, service_time = 0;
  /// Returns the time that requests spent between the two memory levels. Returns nothing if it would be negative, or if
  /// the lower level also serves other units, so that the counts differ.
  std::optional<double> time_between() const {
    if (requested != served || request_time < service_time) return {};
    return request_time - service_time;
  }
};

Traffic traffic_between_l1_and_l2(const Values& values) {
  using Trv = hw::Trv::Stats;
  using Ist = hw::Ist::Stats;
  using Srp = hw::Srp::Stats;
  using L2 = hw::L2Bank::Stats;
  return {.requested = sum_of<hw::Trv>(values, &Trv::l1_fills) + sum_of<hw::Ist>(values, &Ist::l1_fills) +
                       sum_of<hw::Srp>(values, &Srp::cache_fills),
          .served = sum_of<hw::L2Bank>(values, &L2::reads),
          .request_time = time_of<hw::Trv>(values, &Trv::l1_miss_cycles) +
                          time_of<hw::Ist>(values, &Ist::l1_miss_cycles) +
                          time_of<hw::Srp>(values, &Srp::cache_miss_cycles),
          .service_time = time_of<hw::L2Bank>(values, &L2::latency)};
}
Traffic traffic_between_l2_and_memory(const Values& values) {
  using L2 = hw::L2Bank::Stats;
  using Dram = hw::DramChannel::Stats;
  return {.requested = sum_of<hw::L2Bank>(values, &L2::fills),
          .served = sum_of<hw::DramChannel>(values, &Dram::reads),
          .request_time = time_of<hw::L2Bank>(values, &L2::line_cycles),
          .service_time = time_of<hw::DramChannel>(values, &Dram::read_latency)};
}

/// Time that misses spent between two memory levels, in the old and the new run.
struct TrafficPath {
  const char* name;
  double was = 0, is = 0;
  double difference() const { return is - was; }
};

/// Returns the paths between memory levels whose time is known in both runs.
std::vector<TrafficPath> timed_memory_paths(const Values& was, const Values& is) {
  std::vector<TrafficPath> out;
  const auto add = [&](const char* name, Traffic (*traffic)(const Values&)) {
    const std::optional<double> before = traffic(was).time_between(), after = traffic(is).time_between();
    if (before && after) out.push_back({name, *before, *after});
  };
  add("interconnect between first-level caches and L2", traffic_between_l1_and_l2);
  add("path between L2 and memory", traffic_between_l2_and_memory);
  return out;
}

/// Returns the time that first-level misses waited in queues of the core port. The time is independent of the
/// interconnect's latency.
double queue_time(const Values& values) {
  using Port = hw::CorePort;
  return time_of<Port>(values, &Port::Stats::request_wait, Port::kCachePort) +
         time_of<Port>(values, &Port::Stats::line_wait, Port::kCachePort);
}

/// Describes the cycles of one cycle reason in both runs, summed over all units of a kind, in the unit's clock.
std::string moved_text(const Values& was, const Values& is, std::string_view unit, const std::string& reason) {
  const std::string path = fmt::format("units.{}.why.{}", unit, reason);
  const double before = value_or_zero(was, path), after = value_or_zero(is, path);
  return fmt::format("why.{} {} -> {} cycles ({:+})", reason, before, after, after - before);
}

/// The change of a unit's own working time between two runs, and the cycle reason that changed most.
struct WorkTimeChange {
  std::string_view unit;
  double difference = 0;
  const ReasonTimeChange* most = nullptr;
};

std::vector<WorkTimeChange> work_changes(const std::vector<ReasonTimeChange>& moves) {
  std::vector<WorkTimeChange> out;
  for (const ReasonTimeChange& move : moves) {
    if (move.kind != sim::ReasonKind::kWorking || move.difference() == 0) continue;
    if (out.empty() || out.back().unit != move.unit) out.push_back({move.unit, 0, &move});
    WorkTimeChange& own = out.back();
    own.difference += move.difference();
    if (std::abs(move.difference()) > std::abs(own.most->difference())) own.most = &move;
  }
  return out;
}

}  // namespace

std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is) {
  const auto units = was.lower_bound("units.");
  if (units == was.end() || !units->first.starts_with("units."))
    return std::nullopt;  // the suite does not keep counters of units
  const std::vector<ReasonTimeChange> moves = reason_time_changes(was, is);
  const std::vector<WorkTimeChange> owns = work_changes(moves);
  constexpr double kNoticeable = 0.1;  // a change counts from this share of the largest change on; chosen by hand
  const double cycles = std::abs(value_or_zero(is, "totals.cycles") - value_or_zero(was, "totals.cycles"));
  double all = 0;
  for (const WorkTimeChange& own : owns) all += std::abs(own.difference);
  const auto most =
      std::ranges::max_element(owns, {}, [](const WorkTimeChange& own) { return std::abs(own.difference); });
  const double own = most == owns.end() ? 0 : std::abs(most->difference);

  const std::vector<TrafficPath> counted = timed_memory_paths(was, is);
  const auto way = std::ranges::max_element(counted, {}, [](const TrafficPath& w) { return std::abs(w.difference()); });
  const double on_way = way == counted.end() ? 0 : std::abs(way->difference());
  if (own > 0 && own >= kNoticeable * std::max(cycles, on_way)) {
    return LocatedRegression{std::string(most->unit), moved_text(was, is, most->unit, most->most->reason), own / all};
  }
  if (on_way >= kNoticeable * cycles && on_way > 0) {
    return LocatedRegression{
        way->name,
        fmt::format("misses spent {:.0f} -> {:.0f} T&I cycles there ({:+.0f})", way->was, way->is, way->difference()),
        on_way / (on_way + all + std::abs(queue_time(is) - queue_time(was)))};
  }
  double waited = 0;
  for (const ReasonTimeChange& move : moves) {
    if (move.kind == sim::ReasonKind::kWaiting) waited = std::max(waited, std::abs(move.difference()));
  }
  for (const ReasonTimeChange& move : moves) {
    if (move.kind != sim::ReasonKind::kWaiting || waited == 0 || std::abs(move.difference()) < waited / 2) continue;
    return LocatedRegression{std::string(move.unit), moved_text(was, is, move.unit, move.reason),
                             waited / (waited + all)};
  }
  return {};
}

std::optional<LocatedRegression> largest_change_in_unit(std::string_view unit, const Values& was, const Values& is) {
  const std::vector<ReasonTimeChange> moves = reason_time_changes(was, is);
  const ReasonTimeChange* most = nullptr;
  double own = 0, all = 0;  // change of the unit's working time, and of all units' working time
  for (const ReasonTimeChange& move : moves) {
    const bool is_work = move.kind == sim::ReasonKind::kWorking, is_inside = is_part_of(move.unit, unit);
    const double size = std::abs(move.difference());
    if (is_work) all += size;
    if (is_work && is_inside) own += size;
    if (!is_inside || size == 0 || !(is_work || move.kind == sim::ReasonKind::kWaiting)) continue;
    if (most == nullptr || size > std::abs(most->difference())) most = &move;
  }
  if (most == nullptr) return {};
  return LocatedRegression{std::string(most->unit), moved_text(was, is, most->unit, most->reason),
                           all == 0 ? 0 : own / all};
}

}  // namespace tools
