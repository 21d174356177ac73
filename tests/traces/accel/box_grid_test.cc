#include <cmath>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/node_format.h"
#include "traces/scenes/builtin.h"

// Tests that boxes in hybrid number format contain those in floats.

namespace traces {
namespace {

/// Expects that all boxes of `hybrid` are integers of 19 bits, and contain those of `floats` with at most one step of
/// margin on each side.
void expect_around(const MemoryImage& hybrid, const MemoryImage& floats) {
  ASSERT_TRUE(hybrid.grid.has_value());
  const BoxGrid& grid = *hybrid.grid;
  ASSERT_EQ(hybrid.nodes.size(), floats.nodes.size());
  for (std::size_t i = 0; i < floats.nodes.size(); ++i) {
    const NodeRecord &h = hybrid.nodes[i], &f = floats.nodes[i];
    for (int c = 0; c < 2; ++c) {
      ASSERT_EQ(h.child[c], f.child[c]);
      if (f.child[c] == kNoChild) continue;
      const float* planes[2][3] = {{h.x, h.y, h.z}, {f.x, f.y, f.z}};
      for (int a = 0; a < 3; ++a) {
        const float low = planes[0][a][c], high = planes[0][a][2 + c];
        const float lower = planes[1][a][c], upper = planes[1][a][2 + c];
        ASSERT_TRUE(low == std::floor(low) && high == std::floor(high));
        ASSERT_TRUE(low >= 0 && low <= high && high <= 524287) << low << " to " << high;
        ASSERT_LE(grid.plane_position(low, a), lower);
        ASSERT_GE(grid.plane_position(high, a), upper);
        ASSERT_GE(grid.plane_position(low + 1.0, a), lower);
        ASSERT_LE(grid.plane_position(high - 1.0, a), upper);
      }
    }
  }
}

TEST(HybridBoxes, ContainFloatBoxesWithinAStepInBuiltInScenes) {
  for (const BuiltinInfo& info : builtin_scenes()) {
    SCOPED_TRACE(info.name);
    if (info.triangles > 100'000 && info.name != "hairball") continue;  // larger scenes take seconds to build
    const MemoryImage floats = build_memory_image(build_scene(info.name, {.triangles = 20000}));
    MemoryImage hybrid = floats;
    round_boxes_to_grid(hybrid);
    expect_around(hybrid, floats);
  }
}

TEST(HybridBoxes, ContainFloatBoxesInFlatTinyHugeAndFarScenes) {
  for (const glm::vec3 scale : {glm::vec3(1), glm::vec3(1, 0, 1), glm::vec3(0, 3, 0), glm::vec3(1, 1, 1e-7F),
                                glm::vec3(1e-20F), glm::vec3(1e20F, 1, 1)}) {
    for (const float offset : {0.0F, -7.0F, 1e6F, -1e12F}) {
      SCOPED_TRACE(testing::Message() << scale.x << " " << scale.y << " " << scale.z << " at " << offset);
      Scene scene = triangle_soup(300, 0.2F);
      for (glm::vec3& p : scene.meshes[0].positions) p = p * scale + offset;
      expect_around(build_memory_image(scene, {.numbers = BoxNumbers::kHybrid}), build_memory_image(scene));
    }
  }
}

TEST(HybridBoxes, OfAMovedSceneUseAGridOfItsNewBounds) {
  const Scene scene = triangle_soup(500, 0.1F);
  Scene moved = scene;
  for (glm::vec3& p : moved.meshes[0].positions) p = p * glm::vec3(3, 1, 0.5F) + 10.0F;
  const BvhConfig config{.numbers = BoxNumbers::kHybrid};
  MemoryImage hybrid = build_memory_image(scene, config), floats = build_memory_image(scene);
  const BoxGrid before = *hybrid.grid;
  refit_memory_image(moved, hybrid);
  refit_memory_image(moved, floats);
  EXPECT_FALSE(*hybrid.grid == before);
  EXPECT_EQ(hybrid.grid->lower_corner(), hybrid.lower);
  expect_around(hybrid, floats);
  refit_memory_image(scene, hybrid);
  EXPECT_EQ(bvh_hash(hybrid), bvh_hash(build_memory_image(scene, config))) << "and back";
}

TEST(HybridBoxes, HaveAnotherHashAndAboutEqualCost) {
  const Scene scene = triangle_soup(2000, 0.05F);
  const MemoryImage hybrid = build_memory_image(scene, {.numbers = BoxNumbers::kHybrid});
  const MemoryImage floats = build_memory_image(scene);
  EXPECT_NE(bvh_hash(hybrid), bvh_hash(floats));
  MemoryImage elsewhere = hybrid;
  elsewhere.grid = BoxGrid(hybrid.lower - 1.0F, hybrid.upper - 1.0F);
  EXPECT_NE(bvh_hash(hybrid), bvh_hash(elsewhere)) << "the same planes of another grid";
  const double cost = bvh_info(floats).sah_cost;
  EXPECT_GT(bvh_info(hybrid).sah_cost, cost);
  EXPECT_LT(bvh_info(hybrid).sah_cost, 1.001 * cost);
}

TEST(BoxGrid, SpreadsItsPlanesOverTheScene) {
  const BoxGrid grid({-1, 0, 5}, {1, 4, 5});
  EXPECT_EQ(grid.plane_below(-1, 0), 0);
  EXPECT_GE(grid.plane_above(1, 0), 524286) << "of 524287";
  EXPECT_FLOAT_EQ(grid.plane_spacing().x, 2.0F / 524286);
  EXPECT_FLOAT_EQ(grid.plane_spacing().y, 4.0F / 524286);
  EXPECT_FLOAT_EQ(grid.plane_spacing().z, 4.0F / 1024 / 524286) << "flat";
  EXPECT_EQ(grid.plane_below(5, 2), 0);
  EXPECT_EQ(grid.plane_above(5, 2), 0);
  const auto on_plane = static_cast<float>(grid.plane_position(3, 0));
  EXPECT_LE(grid.plane_below(on_plane, 0), 3);
  EXPECT_GE(grid.plane_above(on_plane, 0), 3);
}

}  // namespace
}  // namespace traces
