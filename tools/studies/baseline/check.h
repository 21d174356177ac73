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

/// Keys in which two configurations differ, in the order of their names.
struct ChangedKeys {
  std::vector<KeyPair> changed;  ///< keys of both, with other values
  std::vector<KeyPair> of_one;   ///< keys of only one, due to another model or table; the missing value is "none"
};
ChangedKeys changed_keys(const FlatConfig& was, const FlatConfig& is);

/// Returns the unit that a configuration key belongs to, by the groups of the key from the innermost to the outermost:
///   1. the kind of units named like the group: "core.tni.trv" for "tni.trv.l1.size";
///   2. the kind of units inside the group, if there is only one: "l2.bank" for "l2.mshrs";
///   3. else the outermost group: "tni" for "tni.miss_handling", "clocks" for "clocks.tni".
/// Empty for a key without a group: "cores".
std::string unit_of_key(std::string_view key);

/// True if a unit kind is the unit that a key configures, or a subunit of it: "core.tni.trv" is part of "tni".
bool is_part_of(std::string_view kind, std::string_view unit);

/// Returns the change of one key as text: "l2.mshrs was 32, is 8".
std::string changed_keys_text(const KeyPair& key);
/// Returns the changes of several keys as text, "Changed in l2.bank: l2.mshrs was 32, is 8": a line per key, or per
/// group of more than four keys, sorted by unit.
std::string changed_keys_text(const std::vector<KeyPair>& keys);

/// The unit that most likely changed between two runs of equal work, according to the counters.
struct LocatedRegression {
  std::string unit;      ///< kind of unit, "core.tni.trv", or the path between two levels of memory
  std::string moved;     ///< change of the counter: "why.pipe 1234 -> 1267 cycles (+33)"
  double certainty = 0;  ///< 0 to 1; less if other units also moved
  bool is_certain() const { return certainty >= 0.9; }
};

/// Finds the unit that most likely changed. Nothing without counters of units, or if none moved.
///   1. The unit whose working time moved most. Units that wait for a slower unit do not work longer themselves.
///   2. Else the path between two levels of memory: the miss time of the upper level minus the service time of the
///      lower level, if both counted the same misses.
///   3. Else the unit nearest to the memory whose waiting time moved.
/// The result is certain if one thing happens at a time; with contention other units move, too.
std::optional<LocatedRegression> locate_regression(const Values& was, const Values& is);

/// Finds the reason, of work or of waiting, that moved most in a unit that is known to have changed (unit_of_key()).
/// The certainty is the unit's share of all work that moved. Nothing if no reason moved.
std::optional<LocatedRegression> largest_move_in(std::string_view unit, const Values& was, const Values& is);

/// A kept value that differs from the stored one. `was` or `is` is empty if the value is missing on that side.
struct Moved {
  std::string path;
  std::optional<double> was, is;
  std::optional<double> noise;  ///< half of the 95 % interval of the difference of means; only with replicates
};

/// A run compared with its stored values.
struct RunCheck {
  std::string name;
  std::string error;                 ///< reason that the run has no result
  std::vector<std::string> refused;  ///< reasons that stored and new values are not comparable
  std::vector<Moved> moved;          ///< ordered as `keep` of the suite, then by path
  std::size_t values = 0;            ///< number of kept values
  ChangedKeys keys;                  ///< keys that differ, except those that change the recorded work
  /// Unit that most likely changed, by its counters; units of changed keys are tried first.
  std::optional<LocatedRegression> located;
  double seconds = 0;
  /// True if the unit can be named for this run alone: because a key changed, or because its counters are certain.
  bool can_report_changed_unit() const { return located && (located->is_certain() || !keys.changed.empty()); }
  bool is_good() const { return error.empty() && refused.empty() && moved.empty(); }
};

/// The results of all runs of a suite, compared with stored values if there are any.
struct Checked {
  std::vector<RunCheck> runs;
  Baseline now;  ///< values to store, of the runs that have results
  std::size_t count_if(bool (*predicate)(const RunCheck&)) const;
};

/// Simulates a suite, `jobs` runs at once, and calls `report` for each run in order. `stored` may be null. Throws
/// InputError if no run has a path of `keep`; misspelled paths are found before the runs, by small pictures of each
/// program.
Checked check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                    const std::function<void(const RunCheck&)>& report);

}  // namespace tools
