#include <array>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "tests/full_size.h"
#include "tests/validation/figures.h"
#include "tools/studies/reproduce/plan.h"

// Compares mechanisms of the SGRT papers with publications. DEVIATIONS.md explains deviations (U1 to U5). Tests assert
// their measured range on built-in scenes.

namespace tools::reproduce {
namespace {

/// Returns the metrics of a setting of `raywatt reproduce sgrt-units` on a built-in scene.
auto sgrt_units_figures(const std::string& scene, const std::string& setting, std::uint32_t width = 256) {
  return measure(sgrt_unit_cases(false), scene, setting, width);
}

constexpr std::array<const char*, 2> kSceneNames = {"car", "chess"};
constexpr std::span<const char* const> kScenes = kSceneNames;

TEST(SgrtUnits, TwoBoxTestersAreAsMuchFasterAsOneHasMoreToIssueWhereTraversalSetsThePace) {
  for (const char* scene : kScenes.first(test::full_or(std::size_t{2}, std::size_t{1}))) {
    const auto alone = sgrt_units_figures(scene, "2-AABB against 1-AABB, T&I alone, one TRV");
    expect_between("speed, published up to 2.9", alone.at("speedup"), 2.0, 2.6);
    expect_between("energy efficiency", alone.at("tni_perf_per_watt"), 1.25, 1.5);
  }
}

TEST(SgrtUnits, FourTraversalUnitsGainLessSinceTheyWaitForOneIntersectionUnitOrForShaders) {  // U1
  if (test::is_full_size()) {
    const auto alone = sgrt_units_figures("car", "2-AABB against 1-AABB, T&I alone");
    expect_between("speed of T&I units", alone.at("speedup"), 1.2, 1.6);
  }
  expect_between("speed of all", sgrt_units_figures("car", "2-AABB against 1-AABB, whole GPU").at("speedup"), 1.1, 1.4);
}

TEST(SgrtUnits, ReorderSavesRetriesNotFirstMisses) {  // U2
  for (const char* scene : kScenes.first(test::full_or(std::size_t{2}, std::size_t{1}))) {
    const auto whole = sgrt_units_figures(scene, "reorder against bypass, whole GPU");
    expect_between("hits per probe, published up to 1.117", whole.at("l1_hits_ratio"), 1.08, 1.3);
    expect_between("hits per first probe", whole.at("l1_first_hits_ratio"), 0.97, 1.01);
    expect_between("lines brought in", whole.at("l1_fills_ratio"), 0.95, 1.02);
  }
  if (!test::is_full_size()) return;
  const auto alone = sgrt_units_figures("car", "reorder against bypass, T&I alone");
  expect_between("hits per probe, T&I alone", alone.at("l1_hits_ratio"), 1.2, 1.6);
}

TEST(SgrtUnits, ReorderSavesFarLessEnergyThanPublishedSinceWaitingCostsLittle) {  // U3
  const auto bypass = sgrt_units_figures("chess", "reorder against bypass, T&I alone");
  expect_between("energy efficiency, published up to 4.7", bypass.at("tni_perf_per_watt"), 1.2, 1.6);
  expect_between("speed", bypass.at("speedup"), 0.95, 1.1);
  if (!test::is_full_size()) return;
  const auto blocking = sgrt_units_figures("chess", "reorder against blocking, T&I alone");
  expect_between("energy efficiency", blocking.at("tni_perf_per_watt"), 1.05, 1.3);
  expect_between("speed", blocking.at("speedup"), 3.2, 4.6);
}

TEST(SgrtUnits, TheDirectInterfaceSavesThatMuchOfMemoryTrafficAsTheSceneLeaves) {  // U4
  const double few_pixels = sgrt_units_figures("car", "on against off, T&I alone").at("dram_bytes_ratio");
  expect_between("bytes, published 0.52", few_pixels, 0.35, 0.55);
  if (!test::is_full_size()) return;
  const double many = sgrt_units_figures("car", "on against off, T&I alone", 512).at("dram_bytes_ratio");
  EXPECT_LT(many, 0.8 * few_pixels) << "rays that share the scene's lines still have records of their own";
}

TEST(SgrtUnits, TheDirectInterfaceIsFasterByWhatWasPublishedOnlyWhereShadersDoNotSetThePace) {  // U4
  expect_between("T&I units, published 1.5", sgrt_units_figures("chess", "on against off, T&I alone").at("speedup"),
                 1.4, 2.0);
  if (!test::is_full_size()) return;
  expect_between("all, published 1.5", sgrt_units_figures("chess", "on against off, whole GPU").at("speedup"), 1.2,
                 1.6);
}

TEST(SgrtUnits, HybridNumbersSaveStorageAndLinesButAVisitOftenReadsTwo) {  // U5
  const auto whole = sgrt_units_figures("car", "hybrid against floats, whole GPU");
  expect_between("bytes of boxes, published 0.60", whole.at("box_bytes_ratio"), 0.595, 0.605);
  expect_between("bytes of nodes", whole.at("node_bytes_ratio"), 0.62, 0.63);
  expect_between("lines brought in", whole.at("l1_fills_ratio"), 0.75, 0.95);
  expect_between("speed", whole.at("speedup"), 0.95, 1.02);
  expect_between("energy efficiency", whole.at("tni_perf_per_watt"), 1.03, 1.15);
}

}  // namespace
}  // namespace tools::reproduce
