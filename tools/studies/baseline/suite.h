#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tools/analysis/report_file.h"
#include "tools/noise/noise.h"
#include "tools/run/frame/job_options.h"

namespace tools {

/// A value of a report that a suite stores for each run.
struct Kept {
  std::string text;    ///< report path, an unambiguous end of one, or a group
  double percent = 0;  ///< tolerance, in percent of the stored value
  std::string at;      ///< "file:line:column" of the entry
};

struct SuiteRun {
  std::string name;
  JobOptions options;
};

/// Small runs whose values are stored and checked.
struct Suite {
  std::filesystem::path file;
  std::filesystem::path values;  ///< file of the stored values
  std::vector<Kept> kept;
  std::vector<SuiteRun> runs;
  std::string suite_name() const { return file.stem().string(); }
};

/// Reads a suite and the configurations of all its runs. Throws InputError with file, line and column.
Suite load_suite(const std::filesystem::path& file);

/// Origin of a run's values.
struct Facts {
  std::string program, scene_sha256, bvh_hash;
  FlatConfig config;  ///< without the scene name, because files can be moved
};

/// Numbers of a report by path. Zeros are not stored.
using Values = std::map<std::string, double>;
/// Statistics of the replicates of a run, by report path.
using StoredDraws = std::map<std::string, Draws>;

struct StoredRun {
  Facts facts;
  Values values;
  StoredDraws draws;  ///< empty if recorded without replicates
};

/// The stored values of a suite, a readable YAML file.
struct Baseline {
  std::string embree;
  std::map<std::string, StoredRun> runs;
};

/// Reads stored values. Throws InputError if the file does not exist or is not a baseline.
Baseline load_baseline(const std::filesystem::path& file);
/// Returns the text of a baseline file, runs in the order of the suite.
std::string baseline_text(const Baseline& baseline, const Suite& suite);

}  // namespace tools
