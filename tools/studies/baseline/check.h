#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/studies/baseline/suite.h"
#include "tools/studies/compare/compare.h"

namespace tools {

/// Configuration keys whose values differ between two runs, sorted by name.
struct ChangedKeys {
  std::vector<KeyPair> changed;  ///< keys that both configurations have
  std::vector<KeyPair> of_one;   ///< keys of only one configuration; the missing value is "none"
};
ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is);

/// Returns the hardware unit that a configuration key configures. Groups of the key are tried from the innermost:
///   1. the kind of unit with the name of the group: "core.tni.trv" for "tni.trv.l1.size";
///   2. the only kind of unit inside the group: "l2.bank" for "l2.mshrs";
///   3. if no group has a unit, the outermost group: "tni" for "tni.miss_handling", "clocks" for "clocks.tni".
/// Returns an empty text for a key without a group, such as "cores".
std::string unit_of_key(std::string_view key);

/// True if `kind` equals `unit` or is a subunit of it: "core.tni.trv" is part of "tni".
bool is_part_of(std::string_view kind, std::string_view unit);

/// Describes the change of one configuration key: "l2.mshrs was 32, is 8".
std::string changed_key_text(const KeyPair& key);
/// Describes the changes of configuration keys, one line per key, sorted by unit: "Changed in l2.bank: l2.mshrs was 32,
/// is 8". If more than four keys of a group changed, the group has a single line.
std::string changed_keys_text(const std::vector<KeyPair>& keys);

/// The hardware unit that most likely changed between two runs of the same work, derived from performance counters.
struct LocatedRegression {
  std::string unit;      ///< kind of unit, such as "core.tni.trv", or a path between two memory levels
  std::string moved;     ///< change of the decisive counter: "why.pipe 1234 -> 1267 cycles (+33)"
  double certainty = 0;  ///< 0 to 1; lower if counters of other units changed, too
  bool is_certain() const { return certainty >= 0.9; }
};

/// Finds the hardware unit that most likely changed between the runs `was` and `is`, from their counters:
///   1. The unit whose working time changed most. Working time excludes waiting for slower units.
///   2. Otherwise the path between two memory levels, if both levels counted the same misses. Its time is the miss time
///      of the level nearer to the core, minus the service time of the other level.
///   3. Otherwise, of the units whose waiting time changed much, the one nearest to the DRAM.
/// The certainty is high if the change affects no other unit. With contention the times of other units change, too.
/// Returns nothing without counters, or if none changed.
std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is);

/// Finds the cycle reason whose time changed most in `unit`, whose configuration keys changed. The certainty is this
/// unit's share of the changes of all units' working times. Returns nothing if no time of the unit changed.
std::optional<LocatedRegression> largest_change_in_unit(std::string_view unit, const Values& was, const Values& is);

/// A report value of a run that differs from its stored value. `was` (stored) is empty if no value is stored, `is`
/// (new) if the run lacks the value.
struct Moved {
  std::string path;
  std::optional<double> was, is;
  std::optional<double> noise;  ///< half-width of the 95 % interval of the difference; only with replicates
};

/// Result of comparing a run of a suite with its stored values.
struct RunCheck {
  std::string name;
  std::string error;                 ///< reason that the run has no result; empty if it has one
  std::vector<std::string> refused;  ///< reasons that stored and new values are not comparable
  std::vector<Moved> moved;          ///< changed values, in the order of `keep` in the suite, then by path
  std::size_t values = 0;            ///< number of values that the suite keeps of the run
  ChangedKeys keys;                  ///< changed configuration keys, except those that change the rendered rays
  /// The hardware unit that most likely changed. Units whose configuration keys changed are tried first.
  std::optional<LocatedRegression> located;
  double seconds = 0;
  /// True if `located` is reliable from this run alone: a configuration key changed, or the counters are unambiguous.
  bool can_report_changed_unit() const { return located && (located->is_certain() || !keys.changed.empty()); }
  bool is_good() const { return error.empty() && refused.empty() && moved.empty(); }
};

/// The results of all runs of a suite, compared with the stored values.
struct SuiteCheck {
  std::vector<RunCheck> runs;
  Baseline now;  ///< new values of the runs that have results
  std::size_t count_if(bool (*predicate)(const RunCheck&)) const;
};

/// Simulates a suite, `jobs` runs at once, and calls `report` for each run in the suite's order. `stored`: values to
/// compare with, or null. Throws InputError if a report path in the suite's `keep` matches no run. Misspelt paths are
/// found by short trial runs before the suite is simulated.
SuiteCheck check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                       const std::function<void(const RunCheck&)>& report);

}  // namespace tools
