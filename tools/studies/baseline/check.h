#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/baseline/measure.h"
#include "tools/studies/baseline/regression_locator.h"
#include "tools/studies/compare/compare.h"

namespace tools {

/// A kept value that is not what is stored; nothing where there is none.
struct Moved {
  std::string path;
  std::optional<double> was, is;
};

/// What has become of a run since its values were stored.
struct RunCheck {
  std::string name;
  std::string error;                 ///< it could not be computed
  std::vector<std::string> refused;  ///< why stored and new values cannot be held against each other
  std::vector<Moved> moved;          ///< in the order of the suite's `keep`, and of paths
  std::size_t values = 0;            ///< kept
  std::vector<KeyPair> config;       ///< keys that differ and may explain it
  std::optional<Suspect> suspect;
  double seconds = 0;
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

/// Of the runs that moved, the one that names a unit most clearly; null if none does.
const RunCheck* clearest(const Checked& checked);

/// "ok  teapot", "MOVED  teapot: 12 of 300 values, cycles 100 -> 104 (+4.0 %)": a line.
std::string check_line(const RunCheck& run);
/// What moved, and in which unit: lines for the runs that are not good.
std::string check_details(const Checked& checked);
/// "100 -> 104 (+4, +4.0 %)"
std::string moved_text(const Moved& moved);

}  // namespace tools
