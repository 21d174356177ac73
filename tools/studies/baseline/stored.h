#pragma once
#include <filesystem>
#include <map>
#include <string>

#include "tools/analysis/report_file.h"
#include "tools/noise/statistics.h"
#include "tools/studies/baseline/suite.h"

namespace tools {

/// Origin of a run's values.
struct Facts {
  std::string program, scene_sha256, bvh_hash;
  FlatConfig config;  ///< without the name of the scene: files move
};

/// Numbers by report path. Of what is stored, those that are not 0.
using Values = std::map<std::string, double>;
/// Replicates of figures that noise moves, by report path.
using StoredDraws = std::map<std::string, Draws>;

struct StoredRun {
  Facts facts;
  Values values;
  StoredDraws draws;  ///< empty unless they were recorded with replicates
};

/// The stored values of a suite: a YAML file for people and for diffs.
struct Baseline {
  std::string embree;
  std::map<std::string, StoredRun> runs;
};

/// Reads stored values. InputError if there are none or if they are no baseline.
Baseline load_baseline(const std::filesystem::path& file);
/// As load_baseline() reads it, runs in the order of the suite.
std::string baseline_text(const Baseline& baseline, const Suite& suite);

}  // namespace tools
