#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tests/tools/program.h"
#include "tools/studies/sweep/plan.h"

namespace test {

/// A sweep's file of these lines, with what makes its points small.
std::filesystem::path write_sweep(const TempFolder& folder, const std::string& lines,
                                  const std::string& name = "sweep.yaml");

/// The points of such a sweep.
std::vector<tools::sweep::Point> points_of(const std::string& lines);
/// What is wrong with such a sweep; empty if nothing is.
std::string complaint_of(const std::string& lines);

/// `raywatt sweep run` of that file into folder/out with the store folder/store.
Words sweep_run(const TempFolder& folder, const std::filesystem::path& file, const Words& more = {});

/// What points have as values of their axes: "cores=1 tni.trvs=2".
Words labels_of(const std::vector<tools::sweep::Point>& points);

/// Number of finished points in a store.
std::size_t points_in(const std::filesystem::path& store);

/// report.json without what differs from run to run.
nlohmann::json comparable(nlohmann::json report);

}  // namespace test
