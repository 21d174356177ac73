#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/baseline/changed_keys.h"
#include "tools/studies/baseline/measure.h"
#include "tools/studies/baseline/regression_locator.h"

namespace tools {

/// A kept value that is not what is stored; nothing where there is none.
struct Moved {
  std::string path;
  std::optional<double> was, is;
  std::optional<double> noise;  ///< half of the difference's 95 % interval, where replicates tell: means are compared
};

/// A run now against its stored values.
struct RunCheck {
  std::string name;
  std::string error;                         ///< it could not be computed
  std::vector<std::string> refused;          ///< why stored and new values cannot be held against each other
  std::vector<Moved> moved;                  ///< in the order of the suite's `keep`, and of paths
  std::size_t values = 0;                    ///< kept
  ChangedKeys keys;                          ///< keys that differ, without those that change the work
  std::optional<LocatedRegression> located;  ///< by the counters; in the unit of a changed key, if there is one
  double seconds = 0;
  /// True if the unit is certain enough to be named for this run alone: by a changed key, or by its counters.
  bool names_unit() const { return located && (located->is_clear() || !keys.changed.empty()); }
  bool good() const { return error.empty() && refused.empty() && moved.empty(); }
};

/// A suite measured anew and held against stored values, if there are any.
struct Checked {
  std::vector<RunCheck> runs;
  Baseline now;  ///< what would be stored; of runs that could be computed
  std::size_t count(bool (*of)(const RunCheck&)) const;
};

/// Measures a suite, `jobs` runs at once. `stored` may be null. `tell` hears of each run in turn. InputError if `keep`
/// has what no run has.
Checked check_suite(const Suite& suite, const Baseline* stored, std::uint32_t jobs,
                    const std::function<void(const RunCheck&)>& tell);

/// The run that moved and names a unit most clearly; null if none does.
const RunCheck* clearest(const Checked& checked);

/// "ok  teapot", "MOVED  teapot: 12 of 300 values, cycles 100 -> 104 (+4.0 %)": a line.
std::string check_line(const RunCheck& run);
/// Lines on the runs that are not good: keys that changed, figures that moved, and the unit.
std::string check_details(const Checked& checked);
/// Returns "most likely in l2.bank: why.lookup 1921 -> 2364 cycles (+443)". The run must have a located unit.
std::string located_text(const RunCheck& run);
/// "100 -> 104 (+4, +4.0 %)"
std::string moved_text(const Moved& moved);

/// Writes a check as JUnit XML, which continuous integration systems show: a test case for each run. IoError.
/// InputError if the file is there and was not made by write_junit(); with `force`, unless it is a regular file.
void check_junit(const std::filesystem::path& file, bool force);
void write_junit(const std::filesystem::path& file, const Suite& suite, const Checked& checked);

}  // namespace tools
