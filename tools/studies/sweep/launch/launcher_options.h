#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/store/folder.h"

namespace tools {

/// The launcher that computes the points of a sweep or a search.
struct LauncherOptions {
  std::string launcher = "local";
  std::uint32_t jobs = 0;
  bool retry_failed = false;
  std::vector<std::string> slurm_arguments;
  std::uint64_t chunk = 0;
};

/// InputError for options of another launcher.
void check(const LauncherOptions& options);
std::unique_ptr<sweep::Launcher> make_launcher(const LauncherOptions& options, const sweep::SweepFolder& folder);

}  // namespace tools
