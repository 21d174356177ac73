#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/store.h"

namespace tools {

/// Options of `raywatt sweep run`. The sweep is read from `file`, or with `resume` from the folder `out`.
struct SweepOptions : LauncherOptions {
  std::filesystem::path file, out, store;
  std::vector<std::string> sets;  ///< "key=value", in addition to those of the file
  bool wait = false, resume = false, dry_run = false, quiet = false;
  std::string progress = "auto";
};
/// Simulates all points of a sweep that have no result, then collects the results. Returns kGood, or kCheckFailed if
/// points failed.
int run_sweep(const SweepOptions& options);

/// Options of `raywatt sweep point`, which simulates some points of the sweep in `folder`: chunk number `index` of its
/// points, or of the lines of `list`.
struct PointOptions {
  std::filesystem::path folder, list;
  std::uint64_t index = 0, chunk = 1;
  std::uint32_t jobs = 1;
  bool retry_failed = false;
};
int compute_points(const PointOptions& options);

/// Joins slices that all have results but are still unjoined, because the process of the last slice was killed.
void join_sweep(const sweep::SweepFolder& folder);

/// Prints the progress of the sweep in a folder.
void print_sweep_status(const std::filesystem::path& path, bool json);
/// Shows the progress of a sweep until all points have ended or no process computes them.
void watch_sweep(const std::filesystem::path& path);
/// Prints the first few points that failed, with their errors.
void print_failures(const sweep::Store& store, const std::vector<sweep::Point>& points);
/// Ends the process that runs the sweep in a folder, and cancels the sweep's Slurm jobs.
void cancel_sweep(const std::filesystem::path& path);

}  // namespace tools
