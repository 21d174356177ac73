#include <string>

#include <gtest/gtest.h>

#include "tests/validation/figures.h"
#include "tools/studies/reproduce/plan.h"

// A rasteriser beside the T&I units, against rays alone, beside what was published. What is not reproduced is written
// in DEVIATIONS.md (H1, H2) with its cause, and held here at its measured range, at a small resolution.

namespace tools::reproduce {
namespace {

/// The figures of a setting of `raywatt reproduce hybrid` on a built-in scene.
auto hybrid_figures(const std::string& scene, const std::string& setting, std::uint32_t width = 128) {
  return measure(hybrid(false), scene, setting, width);
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
  // The geometry pass stays what it is while pixels grow in number.
  const auto finer = hybrid_figures("chess", "shadows", 256);
  EXPECT_GT(finer.at("gpu_perf_per_watt"), chess.at("gpu_perf_per_watt"));
  EXPECT_GT(finer.at("speedup"), chess.at("speedup"));
}

}  // namespace
}  // namespace tools::reproduce
