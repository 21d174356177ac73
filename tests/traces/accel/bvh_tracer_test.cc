#include "traces/accel/bvh_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <gtest/gtest.h>

#include "support.h"
#include "tests/full_size.h"
#include "traces/accel/build.h"

namespace traces {
namespace {

/// The hit of a ray, computed in double precision from the equations of the triangles. It is clear if no edge is close.
struct Exact {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t triangle = kNoHit;
  bool clear = true;
};

Exact solve(const MemoryImage& image, const Ray& ray) {
  Exact best;
  for (std::uint32_t i = 0; i < image.triangles.size(); ++i) {
    const glm::dvec3 v0(image.triangles[i].v0);
    const glm::dmat3 m(glm::dvec3(image.triangles[i].v1) - v0, glm::dvec3(image.triangles[i].v2) - v0,
                       -glm::dvec3(ray.direction));
    if (glm::determinant(m) == 0) continue;
    const glm::dvec3 uvt = glm::inverse(m) * (glm::dvec3(ray.origin) - v0);
    const double inside = std::min({uvt.x, uvt.y, 1 - uvt.x - uvt.y, uvt.z - ray.t_min, ray.t_max - uvt.z});
    if (std::fabs(inside) < 1e-4) best.clear = false;
    if (inside > 0 && uvt.z < best.t) best = {uvt.z, i, best.clear};
  }
  return best;
}

TEST(BvhTracer, FindsTheHitsOfTheEquations) {
  for (const float size : {0.02F, 0.3F, 1.5F}) {
    const MemoryImage image = build_memory_image(triangle_soup(400, size));
    const std::vector<Ray> rays = random_rays(20000);
    const std::vector<Hit> hits = trace(BvhTracer(image), rays);
    int clear = 0, found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Exact exact = solve(image, rays[i]);
      if (!exact.clear) continue;
      ++clear;
      ASSERT_EQ(hits[i].triangle, exact.triangle) << "ray " << i;
      if (exact.triangle == kNoHit) continue;
      ++found;
      EXPECT_NEAR(hits[i].t, exact.t, 1e-4 * exact.t + 1e-5 * image.diagonal());
    }
    EXPECT_GT(clear, 10000);
    EXPECT_GT(found, 20);
  }
}

TEST(BvhTracer, FindsTheSameHitsWithAnyTree) {
  for (const std::uint32_t leaf_size : {1U, 4U, 7U}) {
    const MemoryImage soup = build_memory_image(triangle_soup(1000, 0.2F), {.leaf_size = leaf_size});
    const MemoryImage grid = build_memory_image(grid_soup(1000), {.leaf_size = leaf_size});
    for (const MemoryImage* image : {&soup, &grid}) {
      for (const std::vector<Ray>& rays :
           {random_rays(test::full_or(3000U, 1000U)), grid_rays(test::full_or(10000U, 2000U))}) {
        const std::vector<Hit> hits = trace(BvhTracer(*image), rays);
        const std::vector<Hit> blocked = trace(BvhTracer(*image), rays, RayKind::kShadow);
        std::vector<Hit> expected(rays.size());
        for (std::size_t i = 0; i < rays.size(); ++i) {
          expected[i] = test_all(*image, rays[i]);
          EXPECT_EQ(blocked[i].is_hit(), expected[i].is_hit());
        }
        EXPECT_EQ(count_different(hits, expected), 0U);
      }
    }
  }
}

TEST(BvhTracer, PortableArithmeticGivesTheSameBits) {
  for (const Scene& scene : {triangle_soup(3000, 0.1F), grid_soup(2000), with_transparent_triangles(grid_soup(2000))}) {
    const MemoryImage image = build_memory_image(scene, {.leaf_size = 6});
    for (const std::vector<Ray>& rays : {random_rays(20000), grid_rays(20000)}) {
      EXPECT_EQ(count_different_in_portable(image, rays), 0U);
    }
  }
}

/// Returns the number of rays from inside a closed sphere that hit nothing.
std::uint64_t leaks(const MemoryImage& image, const std::vector<Ray>& rays) {
  return static_cast<std::uint64_t>(std::ranges::count_if(trace(BvhTracer(image), rays), std::not_fn(&Hit::is_hit)));
}

/// Returns `count` rays per triangle from inside the sphere, to points on the triangle selected by `target`.
std::vector<Ray> rays_at(const MemoryImage& image, int count, auto&& target) {
  Dice dice(8);
  std::vector<Ray> rays;
  for (const TriangleRecord& t : image.triangles) {
    for (int i = 0; i < count; ++i) {
      const glm::vec3 from = dice.point(-0.3F, 0.3F);
      rays.push_back({.origin = from, .direction = target(t, dice) - from});
    }
  }
  return rays;
}

TEST(BvhTracer, AClosedSphereHasNoLeaks) {
  const MemoryImage image = build_memory_image(sphere(48, 96));
  Dice dice(7);
  std::vector<Ray> rays(1000000);
  for (Ray& ray : rays) ray = {.origin = dice.point(-0.5F, 0.5F), .direction = dice.direction()};
  EXPECT_EQ(leaks(image, rays), 0U);
}

TEST(BvhTracer, RaysAimedAtEdgesDoNotLeak) {
  const MemoryImage image = build_memory_image(sphere(24, 48));
  const std::vector<Ray> rays = rays_at(image, 200, [](const TriangleRecord& t, Dice& dice) {
    const float along = dice.unit();
    return t.v1 * along + t.v2 * (1 - along);
  });
  EXPECT_EQ(leaks(image, rays), 0U);
}

// A known gap, also in Embree: at a vertex, where several edges meet, each edge test is rounded separately.
TEST(BvhTracer, OfRaysAimedAtACornerOneInAThousandSlipsThrough) {
  const MemoryImage image = build_memory_image(sphere(24, 48));
  const std::vector<Ray> rays = rays_at(image, 200, [](const TriangleRecord& t, Dice&) { return t.v1; });
  const double share = static_cast<double>(leaks(image, rays)) / static_cast<double>(rays.size());
  EXPECT_LT(share, 2e-3);
  EXPECT_GT(share, 1e-4);
}

TEST(BvhTracer, HitsBothFacesWithTheWeightsOfTheSecondAndThirdVertex) {
  const MemoryImage image = build_memory_image(one_triangle());
  for (const float side : {1.0F, -1.0F}) {
    Ray ray;
    ray.origin = {0.25F, 0.5F, side};
    ray.direction = {0, 0, -2 * side};
    const Hit hit = trace(BvhTracer(image), {ray})[0];
    EXPECT_FLOAT_EQ(hit.t, 0.5F);
    EXPECT_FLOAT_EQ(hit.u, 0.25F);
    EXPECT_FLOAT_EQ(hit.v, 0.5F);
    EXPECT_EQ(hit.triangle, 0U);
  }
}

TEST(BvhTracer, TheIntervalIsClosed) {
  const MemoryImage image = build_memory_image(one_triangle());
  const BvhTracer tracer(image);
  const auto hits = [&](float t_min, float t_max) {
    return trace(tracer, {Ray{{0.25F, 0.25F, 1}, t_min, {0, 0, -1}, t_max}})[0].is_hit();
  };
  EXPECT_TRUE(hits(0, 1));
  EXPECT_TRUE(hits(1, 2));
  EXPECT_FALSE(hits(0, std::nextafter(1.0F, 0.0F)));
  EXPECT_FALSE(hits(std::nextafter(1.0F, 2.0F), 2));
  EXPECT_FALSE(hits(2, 0));
}

TEST(BvhTracer, ATriangleWithoutAreaIsNeverHit) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}, {0.1F, 0.2F, 0.3F}};
  mesh.triangles = {{0, 1, 2}, {3, 3, 1}, {0, 0, 0}};
  const MemoryImage image = build_memory_image(scene_of(mesh));
  EXPECT_EQ(image.triangles.size(), 3U);
  Dice dice(9);
  std::vector<Ray> rays(20000);
  for (Ray& ray : rays) {
    ray.origin = dice.point(-2, 2);
    ray.direction = mesh.positions[dice.below(3)] * dice.unit() - ray.origin;
  }
  for (const Hit& hit : trace(BvhTracer(image), rays)) ASSERT_FALSE(hit.is_hit());
}

TEST(BvhTracer, OfEqualTrianglesTheOneThatCameFirstWins) {
  Scene scene = triangle_soup(200, 0.3F);
  scene.instances.resize(3, scene.instances[0]);
  const MemoryImage image = build_memory_image(scene);
  int hits = 0;
  for (const Hit& hit : trace(BvhTracer(image), random_rays(5000))) {
    if (!hit.is_hit()) continue;
    ++hits;
    EXPECT_LT(image.triangles[hit.triangle].source, 200U);
  }
  EXPECT_GT(hits, 500);
}

TEST(BvhTracer, AShadowRayEndsAtAnOpaqueHitOrReportsTheNearestFlaggedOne) {
  for (const Scene& scene : {triangle_soup(1000, 0.2F), grid_soup(1000)}) {
    const MemoryImage image = build_memory_image(with_transparent_triangles(scene));
    int flagged = 0, solid = 0, hidden = 0;
    for (const std::vector<Ray>& rays :
         {random_rays(test::full_or(5000U, 2500U)), grid_rays(test::full_or(5000U, 2000U))}) {
      const std::vector<Hit> hits = trace(BvhTracer(image), rays, RayKind::kShadow);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit nearest = test_all(image, rays[i]);
        ASSERT_EQ(hits[i].is_hit(), nearest.is_hit());
        if (!nearest.is_hit()) continue;
        EXPECT_EQ(hits[i].triangle & ~kTriangleMask, image.triangles[hits[i].triangle_index()].hit_flags());
        if (hits[i].is_flagged()) {
          ++flagged;
          ASSERT_EQ(std::memcmp(&hits[i], &nearest, sizeof(Hit)), 0) << "ray " << i;
        } else {
          ++solid;
          hidden += nearest.is_flagged() ? 1 : 0;
          Ray segment = rays[i];
          segment.t_min = segment.t_max = hits[i].t;
          EXPECT_TRUE(test_all(image, segment).is_hit());
        }
      }
    }
    EXPECT_GT(flagged, 300);
    EXPECT_GT(solid, 300);
    EXPECT_GT(hidden, 20) << "solid triangles behind flagged ones are taken when they come first";
  }
}

TEST(BvhTracer, NearestHitsCarryTheFlagsOfTheirTriangle) {
  const MemoryImage image = build_memory_image(with_transparent_triangles(triangle_soup(1000, 0.2F)));
  const std::vector<Ray> rays = random_rays(3000);
  std::vector<Hit> expected;
  for (const Ray& ray : rays) expected.push_back(test_all(image, ray));
  EXPECT_EQ(count_different(trace(BvhTracer(image), rays), expected), 0U);
  EXPECT_GT(std::ranges::count_if(expected, &Hit::is_flagged), 100);
}

TEST(BvhTracer, AnEmptySceneIsMissed) {
  const MemoryImage image = build_memory_image(Scene{});
  for (const Hit& hit : trace(BvhTracer(image), random_rays(10))) EXPECT_FALSE(hit.is_hit());
}

}  // namespace
}  // namespace traces
