#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tools::pages {

struct Options {
  std::vector<std::filesystem::path> inputs;  ///< one run, several runs, or one sweep or search
  std::filesystem::path out;
  bool force = false;
};

/// Writes the page of a run, several runs or a sweep. InputError for other folders, for a mixture of kinds, and for an
/// output that may not be replaced.
void write_report_page(const Options& options);

}  // namespace tools::pages
