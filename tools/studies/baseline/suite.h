#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/job_options.h"

namespace tools {

/// An entry of the list `keep` in a suite: report values that are stored for each run.
struct KeepEntry {
  std::string text;    ///< path of a value, its unambiguous end, or a group of values
  double percent = 0;  ///< tolerance of a check, in percent of the stored value
  std::string at;      ///< position of the entry: "file:line:column"
};

struct SuiteRun {
  std::string name;
  JobOptions options;
};

/// A regression suite: small simulations whose results are compared with stored results.
struct Suite {
  std::filesystem::path file;
  std::filesystem::path values;  ///< file of the stored values
  std::vector<KeepEntry> kept;
  std::vector<SuiteRun> runs;
  std::string suite_name() const { return file.stem().string(); }
};

/// Reads a suite and the configurations of all its runs. Throws InputError with file, line and column.
Suite load_suite(const std::filesystem::path& file);

/// The inputs of a run. To compare values of two runs, all must be equal except configuration keys that change only
/// timing.
struct RunInputs {
  std::string program, scene_sha256, bvh_hash;
  FlatConfig config;  ///< configuration by key; without the scene's name, because the file may be moved
};

/// Numbers of a run's report, by report path. Numbers that are 0 are left out.
using Values = std::map<std::string, double>;
/// Statistics over the replicates of a run, by report path.
using StoredDraws = std::map<std::string, Draws>;

struct StoredRun {
  RunInputs facts;
  Values values;
  StoredDraws draws;  ///< statistics over replicates; empty if recorded without them
};

/// The stored values of a suite, saved as a YAML file.
struct Baseline {
  std::string embree;
  std::map<std::string, StoredRun> runs;
};

/// Reads the stored values of a suite. Throws InputError if the file does not exist or has another format.
Baseline load_baseline(const std::filesystem::path& file);
/// Returns stored values as the text of a YAML file, with runs in the order of the suite.
std::string baseline_text(const Baseline& baseline, const Suite& suite);

}  // namespace tools
