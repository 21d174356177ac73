#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/tools/program.h"
#include "tools/studies/sweep/spec/plan.h"

namespace test {

/// Writes a sweep file of these lines, with settings added that make its points small.
std::filesystem::path write_sweep(const TempFolder& folder, const std::string& lines,
                                  const std::string& name = "sweep.yaml");

/// Returns the points of a small sweep (write_sweep()) whose file has these lines.
std::vector<tools::sweep::Point> points_of(const std::string& lines);
/// Returns the error message for a small sweep whose file has these lines; empty if it is valid.
std::string complaint_of(const std::string& lines);

/// Returns the arguments of `raywatt sweep run` for a sweep file, with results in folder/out and store folder/store.
Words sweep_run(const TempFolder& folder, const std::filesystem::path& file, const Words& more = {});

/// Runs a sweep twice at the same time, into folder/out and folder/second, with two workers each and a common store.
/// Expects that both succeed.
void sweep_twice_at_once(const TempFolder& folder, const std::filesystem::path& file);

/// Returns the axis values of each point as text: "cores=1 tni.trvs=2".
Words axis_labels(const std::vector<tools::sweep::Point>& points);

/// Returns the number of finished points in a store.
std::size_t points_in(const std::filesystem::path& store);

/// Returns a report without the values that differ between equal runs, such as host times.
nlohmann::json comparable(nlohmann::json report);

/// Numbers of points in a run of a sweep: all, computed, found in the store, failed.
using Tally = std::array<int, 4>;
/// Returns the numbers of points of the last run of a sweep, from the log in its folder.
Tally last_run_counts(const std::filesystem::path& out);

}  // namespace test
