#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/studies/sweep/launch/launcher.h"
#include "tools/studies/sweep/spec/point.h"
#include "tools/studies/sweep/store/store.h"

namespace tools {

/// Options of `raywatt sweep run`: a sweep by its file, or with `resume` by its folder `out`.
struct SweepOptions : LauncherOptions {
  std::filesystem::path file, out, store;
  std::vector<std::string> sets;  ///< "key=value", in addition to those of the file
  bool wait = false, resume = false, dry_run = false, quiet = false;
  std::string progress = "auto";
};
/// Computes all points without a result, then collects the results. Returns kGood, or kCheckFailed if points failed.
int run_sweep(const SweepOptions& options);

/// Options of `raywatt sweep point`, which computes a chunk of the points of the sweep in `folder`, or of the ids in
/// `list`.
struct PointOptions {
  std::filesystem::path folder, list;
  std::uint64_t index = 0, chunk = 1;
  std::uint32_t jobs = 1;
  bool retry_failed = false;
};
int compute_points(const PointOptions& options);

/// Joins the slices of points whose slices are all computed but not joined, because the process of the last slice was
/// killed.
void join_sweep(const sweep::SweepFolder& folder);

/// Prints the progress of the sweep in a folder.
void print_sweep_status(const std::filesystem::path& path, bool json);
/// Shows the progress until all points have ended or no process computes them.
void watch_sweep(const std::filesystem::path& path);
/// Prints the first few points that failed, with their errors.
void print_failures(const sweep::Store& store, const std::vector<sweep::Point>& points);
/// Ends the process that runs the sweep in a folder, and its jobs.
void cancel_sweep(const std::filesystem::path& path);

}  // namespace tools
