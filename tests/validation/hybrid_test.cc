#include <string>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"
#include "tools/studies/reproduce/plan.h"

// Compares a rasteriser with T&I units with rays alone and with publications. DEVIATIONS.md explains deviations (H1 to
// H3). Tests assert their measured range at a small resolution.

namespace tools::reproduce {
namespace {

/// Returns the metrics of a setting of `raywatt reproduce hybrid` on a built-in scene.
auto hybrid_figures(const std::string& scene, const std::string& setting, std::uint32_t width = 128) {
  return measure(hybrid_cases(false), scene, setting, width);
}

TEST(HybridFrames, SaveEnergyWhereTrianglesAreFewForThePixels) {  // H1
  const auto shadows = hybrid_figures("cornell", "shadows");
  expect_between("rays left", shadows.at("rays_ratio"), 0.45, 0.5);
  expect_between("performance per watt, published up to 2.18", shadows.at("gpu_perf_per_watt"), 1.02, 1.12);
  expect_between("speed", shadows.at("speedup"), 0.78, 0.88);
  const auto all = hybrid_figures("cornell", "reflections and refractions");
  expect_between("performance per watt with more rays left", all.at("gpu_perf_per_watt"), 1, 1.08);
  EXPECT_GT(all.at("rays_ratio"), shadows.at("rays_ratio"));
}

TEST(HybridFrames, CostMoreThanRaysWhereTrianglesAreSmallerThanPixels) {  // H2
  const auto chess = hybrid_figures("chess", "shadows");
  expect_between("performance per watt, published up to 2.18", chess.at("gpu_perf_per_watt"), 0.75, 0.85);
  expect_between("memory traffic", chess.at("dram_bytes_ratio"), 1.4, 1.7);
  // The cost of the geometry pass does not grow with the number of pixels.
  const auto finer = hybrid_figures("chess", "shadows", 256);
  EXPECT_GT(finer.at("gpu_perf_per_watt"), chess.at("gpu_perf_per_watt"));
  EXPECT_GT(finer.at("speedup"), chess.at("speedup"));
}

TEST(HybridFrames, GainLittleWhereSurfacesSendManyRays) {  // H3
  const auto full = hybrid_figures("cornell", "occlusion and soft shadows");
  expect_between("rays left", full.at("rays_ratio"), 0.88, 0.92);
  expect_between("performance per watt, published up to 2.18", full.at("gpu_perf_per_watt"), 0.96, 1.05);
  const auto half = hybrid_figures("cornell", "occlusion and soft shadows, half rate");
  expect_between("rays left at half rate", half.at("rays_ratio"), 0.74, 0.79);
  expect_between("performance per watt at half rate", half.at("gpu_perf_per_watt"), 0.93, 1.02);
  // The lower rate saves the same share of time without a rasteriser.
  const double saved = half.at("cycles") / full.at("cycles");
  expect_between("cycles at half rate", saved, 0.65, 0.75);
  expect_between("of rays alone", saved * half.at("speedup") / full.at("speedup"), 0.9 * saved, saved);
}

}  // namespace
}  // namespace tools::reproduce
