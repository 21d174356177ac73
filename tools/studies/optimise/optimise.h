#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/studies/optimise/task.h"
#include "tools/studies/sweep/launch/launcher.h"

namespace tools::optimise {

class SearchRun;

/// Options of `raywatt optimise`. They override the settings in the search's file.
struct Options : LauncherOptions {
  std::filesystem::path file, out, store;
  std::optional<std::uint64_t> budget, seed;
  std::string fidelity;
  std::vector<std::string> sets;  ///< "key=value", in addition to those of the file
  std::optional<double> confidence;
  bool check = false;  ///< simulate whole frames of all machines on the front
  bool quiet = false, prints_answer = true;
  std::string progress = "auto";
};

/// Throws InputError for a task that run() would refuse.
void check_task(const Options& options, Task task);

/// Runs a search and writes history.jsonl and front.csv. Returns kCheckFailed if no point is feasible or some failed.
int run(const Options& options);
/// Runs the search `task`, which was read or derived from `options.file`. `text`: contents of a file that describes the
/// search. `on_end`: called after the last simulation.
int run(const Options& options, Task task, const std::string& text,
        const std::function<void(const SearchRun& search)>& on_end = {});

}  // namespace tools::optimise
