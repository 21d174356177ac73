#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tools::pages {

struct Options {
  std::vector<std::filesystem::path> what;  ///< one run, several runs, or one sweep or search
  std::filesystem::path out;
  bool force = false;
};

/// Writes the page of what is given. InputError, and nothing written, for folders of other things, for kinds that do
/// not go together, and for an output that may not be replaced.
void write_report_page(const Options& options);

}  // namespace tools::pages
