#include "tools/cli/launcher.h"

#include <sstream>

#include <CLI/CLI.hpp>

#include "sim/error.h"
#include "tools/studies/sweep/local_launcher.h"
#include "tools/studies/sweep/slurm_launcher.h"

namespace tools {

void add_launcher_options(CLI::App& verb, LauncherOptions& options) {
  verb.add_option("--launcher", options.launcher, "who computes: local, processes on this host; slurm, a job array")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  verb.add_option("-j,--jobs", options.jobs,
                  "points at a time (default: all cores); slurm: tasks of an array at a time")
      ->check(CLI::Range(1, 1024));
  verb.add_option("--slurm-args", options.slurm_arguments,
                  "slurm: options for sbatch, as it knows them: --slurm-args \"--partition=short --time=1:00:00\"")
      ->allow_extra_args(false);
  verb.add_option("--chunk", options.chunk, "slurm: points of a task (default: as many as make a hundred tasks)")
      ->check(CLI::Range(1, 1'000'000));
  verb.add_flag("--retry-failed", options.retry_failed, "points that failed are computed again");
}

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
