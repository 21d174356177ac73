#pragma once
#include <string_view>

namespace tools {

/// Sources and build options of this program.
struct BuildInfo {
  std::string_view version;
  std::string_view git;  ///< commit, or "unknown" outside a repository
  bool dirty;            ///< true if there were uncommitted changes at build time
  std::string_view compiler;
  std::string_view flags;
  std::string_view model_id;   ///< hash of the model's sources and library versions; equal ids give equal results
  std::string_view report_id;  ///< hash of the sources that write reports and estimate results
  std::string_view source_dir;
  std::string_view binary_dir;
};
BuildInfo build_info();

}  // namespace tools
