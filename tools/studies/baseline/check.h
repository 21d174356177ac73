#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/baseline/changes.h"
#include "tools/studies/baseline/suite.h"

namespace tools {

/// A kept value that differs from the stored one. `was` or `is` is empty if the value is missing on that side.
struct Moved {
  std::string path;
  std::optional<double> was, is;
  std::optional<double> noise;  ///< with replicates: half of the 95 % interval of the difference of means
};

/// A run compared with its stored values.
struct RunCheck {
  std::string name;
  std::string error;                         ///< reason that it has no result
  std::vector<std::string> refused;          ///< reasons that stored and new values are not comparable
  std::vector<Moved> moved;                  ///< ordered as `keep` of the suite, then by path
  std::size_t values = 0;                    ///< number of kept values
  ChangedKeys keys;                          ///< keys that differ, except those that change the recorded work
  std::optional<LocatedRegression> located;  ///< by the counters; in the unit of a changed key, if any
  double seconds = 0;
  /// True if the unit can be named for this run alone: because a key changed, or because its counters are certain.
  bool names_unit() const { return located && (located->is_certain() || !keys.changed.empty()); }
  bool is_good() const { return error.empty() && refused.empty() && moved.empty(); }
};

/// The results of a suite, compared with stored values if there are any.
struct Checked {
  std::vector<RunCheck> runs;
  Baseline now;  ///< values to store, of the runs that have results
  std::size_t count_if(bool (*predicate)(const RunCheck&)) const;
};

/// Simulates a suite, `jobs` runs at once, and calls `report` for each run in order. `stored` may be null. InputError
/// if no run has a path of `keep`; misspelled paths are found before the runs, by small pictures of each program.
Checked check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                    const std::function<void(const RunCheck&)>& report);

/// Returns the moved run whose located unit is most certain; null if there is none.
const RunCheck* most_certain(const Checked& checked);

/// Returns a line: "ok  teapot", "MOVED  teapot: 12 of 300 values, cycles 100 -> 104 (+4.0 %)".
std::string check_line(const RunCheck& run);
/// Describes the runs that are not good: changed keys, moved values, and the unit.
std::string check_details(const Checked& checked);
/// Returns "most likely in l2.bank: why.lookup 1921 -> 2364 cycles (+443)". The run must have a located unit.
std::string located_text(const RunCheck& run);
/// "100 -> 104 (+4, +4.0 %)"
std::string moved_text(const Moved& moved);

/// Writes a check as JUnit XML for continuous integration, a test case per run. InputError if the file exists and is
/// not from write_junit(); with `force`, if it is not a regular file.
void check_junit(const std::filesystem::path& file, bool force);
void write_junit(const std::filesystem::path& file, const Suite& suite, const Checked& checked);

}  // namespace tools
