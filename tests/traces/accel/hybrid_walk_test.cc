#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"

// Tests of traversing trees with boxes in hybrid number format.

namespace traces {
namespace {

constexpr BvhConfig kHybrid{.numbers = BoxNumbers::kHybrid};

/// Returns the number of traversal words of all rays.
std::size_t walk_words(const MemoryImage& image, const std::vector<Ray>& rays) {
  std::vector<Hit> hits(rays.size());
  std::vector<std::uint32_t> words, begin;
  WalkSink sink{words, begin};
  BvhTracer(image).trace(rays, RayKind::kPrimary, hits, &sink);
  return words.size();
}

bool same_bits(const Hit& a, const Hit& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Expects the same hits in both images, at the same points of the same triangles; returns their number.
std::size_t expect_same_hits(const Scene& scene, const std::vector<Ray>& rays) {
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  const std::vector<Hit> expected = trace(BvhTracer(floats), rays), found = trace(BvhTracer(hybrid), rays);
  const std::vector<Hit> blocked = trace(BvhTracer(floats), rays, RayKind::kShadow);
  const std::vector<Hit> dark = trace(BvhTracer(hybrid), rays, RayKind::kShadow);
  std::size_t hits = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(same_bits(found[i], expected[i])) << i;
    EXPECT_EQ(dark[i].is_hit(), blocked[i].is_hit()) << i;
    EXPECT_EQ(dark[i].is_flagged(), blocked[i].is_flagged()) << i;
    if (blocked[i].is_flagged()) {
      EXPECT_TRUE(same_bits(dark[i], blocked[i])) << i;
    }
    if (::testing::Test::HasFailure()) return 0;
    hits += expected[i].is_hit();
  }
  return hits;
}

TEST(HybridWalk, FindsTheHitsOfFloatsAndNoOthers) {
  for (const Scene& scene : {triangle_soup(3000, 0.15F), grid_soup(1500),
                             with_transparent_triangles(triangle_soup(3000, 0.15F)), sphere(24, 48), one_triangle()}) {
    EXPECT_GT(expect_same_hits(scene, random_rays(20000)), 20U);
    EXPECT_GT(expect_same_hits(scene, grid_rays(20000)), 20U);
  }
  EXPECT_EQ(expect_same_hits(Scene{}, random_rays(100)), 0U);
}

/// Returns rays from distance `far` to points of the cube from -1 to 1; every fourth is parallel to an axis.
std::vector<Ray> rays_from(float far, std::uint32_t count, const glm::vec3& scale = glm::vec3(1),
                           const glm::vec3& offset = glm::vec3(0)) {
  Dice dice(11);
  std::vector<Ray> rays(count);
  for (Ray& ray : rays) {
    glm::vec3 direction = dice.direction();
    if (dice.below(4) == 0) {
      direction = glm::vec3(0);
      direction[static_cast<int>(dice.below(3))] = dice.below(2) == 0 ? 1.0F : -1.0F;
    }
    const glm::vec3 at = dice.point();
    ray.origin = (at - far * direction) * scale + offset;
    ray.direction = at * scale + offset - ray.origin;
    if (ray.direction == glm::vec3(0)) ray.direction = {0, 0, 1};
  }
  return rays;
}

TEST(HybridWalk, FindsTheHitsOfFloatsFromFarAway) {
  const Scene scene = triangle_soup(3000, 0.15F);
  for (const float far : {0.0F, 1.0F, 30.0F, 3e3F}) {
    SCOPED_TRACE(far);
    EXPECT_GT(expect_same_hits(scene, rays_from(far, 5000)), 2000U);
  }
}

// From farther away rounding gives hits next to triangles, outside all their boxes. No tree finds all of
// these.
TEST(HybridWalk, LosesNoMoreHitsThanFloatsWhereTheTriangleTestIsCoarserThanBoxes) {
  const Scene scene = triangle_soup(1000, 0.15F);
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  for (const float far : {1e5F, 1e7F, 1e12F}) {
    const std::vector<Ray> rays = rays_from(far, 1000);
    std::vector<Hit> all(rays.size());
    std::ranges::transform(rays, all.begin(), [&](const Ray& ray) { return test_all(floats, ray); });
    const auto found = [&](const MemoryImage& image) {
      const std::vector<Hit> hits = trace(BvhTracer(image), rays);
      std::size_t count = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) count += same_bits(hits[i], all[i]) ? 1 : 0;
      return count;
    };
    EXPECT_GE(found(hybrid), found(floats)) << far;
    EXPECT_GT(found(hybrid), rays.size() * 9 / 10) << far;
  }
}

TEST(HybridWalk, FindsTheHitsOfFloatsInFlatStretchedAndFarScenes) {
  for (const glm::vec3 scale : {glm::vec3(1, 0, 1), glm::vec3(1, 1, 1e-6F), glm::vec3(1e9F), glm::vec3(1e-9F)}) {
    for (const float offset : {0.0F, 100.0F, -1e5F}) {
      SCOPED_TRACE(testing::Message() << scale.x << " " << scale.y << " " << scale.z << " at " << offset);
      Scene scene = triangle_soup(2000, 0.15F);
      for (glm::vec3& p : scene.meshes[0].positions) p = p * scale + offset;
      expect_same_hits(scene,
                       rays_from(3, 3000, scale == glm::vec3(1, 0, 1) ? glm::vec3(1) : scale, glm::vec3(offset)));
    }
  }
}

TEST(HybridWalk, StartsOnPlanesOfBoxesAndOfTheGrid) {
  const Scene scene = triangle_soup(3000, 0.15F);
  const MemoryImage hybrid = build_memory_image(scene, kHybrid), floats = build_memory_image(scene);
  Dice dice(12);
  std::vector<Ray> rays(20000);
  for (Ray& ray : rays) {
    const auto node = dice.below(static_cast<std::uint32_t>(floats.nodes.size()));
    const auto axis = static_cast<int>(dice.below(3));
    const auto lane = dice.below(4);
    const auto plane = [&](const NodeRecord& n) { return (axis == 0 ? n.x : axis == 1 ? n.y : n.z)[lane]; };
    ray.origin = dice.point();
    ray.origin[axis] = dice.below(2) == 0
                           ? plane(floats.nodes[node])
                           : static_cast<float>(hybrid.grid->plane_position(plane(hybrid.nodes[node]), axis));
    ray.direction = dice.direction();
    if (dice.below(2) == 0) ray.direction[axis] = 0;  // in the plane
  }
  EXPECT_GT(expect_same_hits(scene, rays), 10000U);
}

TEST(HybridWalk, IsTheSameInPortableArithmetic) {
  for (const Scene& scene : {triangle_soup(3000, 0.1F), grid_soup(2000), with_transparent_triangles(grid_soup(2000))}) {
    const MemoryImage image = build_memory_image(scene, kHybrid);
    for (const std::vector<Ray>& rays : {random_rays(10000), grid_rays(10000), rays_from(1e4F, 1000)}) {
      EXPECT_EQ(count_different_in_portable(image, rays), 0U);
    }
  }
}

TEST(HybridWalk, AgreesWithEmbree) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.2F), kHybrid);
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const VerifyingTracer verifying(image, bvh, embree);
  trace(verifying, random_rays(50000));
  trace(verifying, random_rays(50000, 9), RayKind::kShadow);
  EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
}

TEST(HybridWalk, IsBarelyLongerThanWithFloats) {
  const Scene scene = triangle_soup(5000, 0.05F);
  const std::vector<Ray> rays = random_rays(20000);
  const auto words = [&](const BvhConfig& config) {
    return static_cast<double>(walk_words(build_memory_image(scene, config), rays));
  };
  EXPECT_NEAR(words(kHybrid) / words({}), 1, 0.002);
}

}  // namespace
}  // namespace traces
