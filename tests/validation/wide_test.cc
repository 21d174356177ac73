#include <map>
#include <string>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"
#include "tools/studies/reproduce/plan.h"

// Compares wide trees with publications. DEVIATIONS.md explains deviations (W1 to W4). Tests assert the measured range
// on a built-in scene.

namespace tools::reproduce {
namespace {

/// Returns the metrics of a setting of `raywatt reproduce wide` on the built-in scene `car`, at a width of 128 pixels.
std::map<std::string, double> wide_metrics(const std::string& setting) {
  return measure(wide_cases(false), "car", setting, 128);
}

TEST(WideTrees, OfFourChildrenWithFloatsSaveLessEnergyThanPublished) {  // W1
  const auto primary = wide_metrics("4 children against 2, whole GPU, primary rays");
  expect_between("energy, published 0.85", primary.at("energy_ratio"), 0.92, 0.96);
  expect_between("performance per area, published 1.19", primary.at("perf_per_area"), 1.02, 1.1);
  expect_between("visits", primary.at("visits_ratio"), 0.44, 0.48);
  const auto incoherent = wide_metrics("4 children against 2, whole GPU, incoherent rays");
  expect_between("energy, published 0.76", incoherent.at("energy_ratio"), 1.03, 1.1);
}

TEST(WideTrees, OfFourChildrenWithQuantisedBoxesSaveWhatIsPublished) {  // W1
  const auto alone = wide_metrics("4 children, q8 against 2, T&I alone, incoherent rays");
  expect_between("efficiency of T&I units", alone.at("tni_perf_per_watt"), 1.4, 1.6);
  expect_between("speed", alone.at("speedup"), 1.25, 1.45);
}

TEST(WideTrees, WithFiveStackEntriesVisitFewNodesAgain) {  // W2
  const auto trail = wide_metrics("5 entries, restart_trail, against a full stack, incoherent rays");
  expect_between("visits, published close to 1", trail.at("visits_ratio"), 1, 1.04);
}

TEST(WideTrees, WhoseEntriesHaveNoDistancesTestMoreTriangles) {  // W3
  const auto cull = wide_metrics("entries per child, dropped beyond the hit, against entries per node, primary rays");
  expect_between("triangle tests, published 0.86 to 1", cull.at("tests_ratio"), 0.8, 0.87);
}

TEST(WideTrees, NeedBytesPerTriangleByTheirFormats) {  // W4
  expect_between("q8, pairs", wide_metrics("8 children, q8, pairs").at("bytes_per_triangle"), 42, 46);
  expect_between("q12, full blocks", wide_metrics("8 children, q12, full blocks").at("bytes_per_triangle"), 40, 44);
  expect_between("cw80", wide_metrics("8 children, cw80, octants").at("bytes_per_triangle"), 58, 63);
}

}  // namespace
}  // namespace tools::reproduce
