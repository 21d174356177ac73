#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tools/run/frame/job_options.h"

namespace tools {

/// A value that a suite keeps of its runs.
struct Kept {
  std::string text;    ///< report path, any clear end of one, or a group
  double percent = 0;  ///< tolerance in percent of the stored value; 0: none
  std::string at;      ///< where the suite says so
};

struct SuiteRun {
  std::string name;
  JobOptions options;
};

/// Small runs whose figures are stored and checked.
struct Suite {
  std::filesystem::path file;
  std::filesystem::path values;  ///< where they are stored
  std::vector<Kept> kept;
  std::vector<SuiteRun> runs;
  std::string name() const { return file.stem().string(); }
};

/// Reads a suite. InputError with file, line and column for what is not allowed; that includes every run's
/// configuration, so that nothing is found to be wrong after the first has been computed.
Suite load_suite(const std::filesystem::path& file);

}  // namespace tools
