#include "tools/studies/sweep/launch/launcher_options.h"

#include <sstream>

#include "sim/error.h"
#include "tools/studies/sweep/launch/local_launcher.h"
#include "tools/studies/sweep/launch/slurm_launcher.h"

namespace tools {

void check(const LauncherOptions& options) {
  const bool says_slurm = !options.slurm_arguments.empty() || options.chunk != 0;
  if (options.launcher != "slurm" && says_slurm) {
    throw sim::InputError("--slurm-args and --chunk are for --launcher slurm");
  }
}

std::unique_ptr<sweep::Launcher> make_launcher(const LauncherOptions& options, const sweep::SweepFolder& folder) {
  if (options.launcher == "slurm") {
    std::vector<std::string> arguments = folder.slurm();  // the file's, then the command line's
    for (const std::string& several : options.slurm_arguments) {
      std::istringstream words(several);
      for (std::string word; words >> word;) arguments.push_back(word);
    }
    return std::make_unique<sweep::SlurmLauncher>(folder,
                                                  sweep::SlurmLauncher::Options{.chunk = options.chunk,
                                                                                .tasks = options.jobs,
                                                                                .retry_failed = options.retry_failed,
                                                                                .arguments = std::move(arguments)});
  }
  return std::make_unique<sweep::LocalLauncher>(
      folder.store(),
      sweep::LocalLauncher::Options{.jobs = options.jobs, .retry_failed = options.retry_failed, .log = folder.log()});
}

}  // namespace tools
