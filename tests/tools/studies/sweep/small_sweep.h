#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/tools/program.h"
#include "tools/studies/sweep/spec/plan.h"

namespace test {

/// A sweep's file of these lines, with what makes its points small.
std::filesystem::path write_sweep(const TempFolder& folder, const std::string& lines,
                                  const std::string& name = "sweep.yaml");

/// The points of such a sweep.
std::vector<tools::sweep::Point> points_of(const std::string& lines);
/// Faults of such a sweep; empty if nothing is.
std::string complaint_of(const std::string& lines);

/// `raywatt sweep run` of that file into folder/out with the store folder/store.
Words sweep_run(const TempFolder& folder, const std::filesystem::path& file, const Words& more = {});

/// Runs it twice at once, with two workers each and one store, into folder/out and folder/second; both must end well.
void sweep_twice_at_once(const TempFolder& folder, const std::filesystem::path& file);

/// Values of the points' axes: "cores=1 tni.trvs=2".
Words labels_of(const std::vector<tools::sweep::Point>& points);

/// Number of finished points in a store.
std::size_t points_in(const std::filesystem::path& store);

/// report.json without what differs from run to run.
nlohmann::json comparable(nlohmann::json report);

/// Numbers of points of a run: all, computed, found, failed.
using Tally = std::array<int, 4>;
/// That of the last run in a sweep's folder, by its log.
Tally last_run(const std::filesystem::path& out);

}  // namespace test
