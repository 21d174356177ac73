#include <gtest/gtest.h>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"

namespace traces {
namespace {

/// Returns the number of rays whose results differ: hit or miss, or the triangle.
std::uint64_t disagreements(const MemoryImage& image, const std::vector<Ray>& rays, RayKind kind) {
  const std::vector<Hit> ours = trace(BvhTracer(image), rays, kind);
  const std::vector<Hit> truth = trace(EmbreeTracer(image, 1), rays, kind);
  std::uint64_t n = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool same =
        kind == RayKind::kShadow ? ours[i].is_hit() == truth[i].is_hit() : ours[i].triangle == truth[i].triangle;
    n += same ? 0U : 1U;
    if (same && kind != RayKind::kShadow && truth[i].is_hit()) {
      EXPECT_NEAR(ours[i].t, truth[i].t, 1e-4 * truth[i].t + 1e-5 * image.diagonal());
      EXPECT_NEAR(ours[i].u, truth[i].u, 1e-3);
      EXPECT_NEAR(ours[i].v, truth[i].v, 1e-3);
    }
  }
  return n;
}

TEST(EmbreeTracer, AgreesOnRandomTriangles) {
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.2F));
  EXPECT_EQ(disagreements(image, random_rays(50000), RayKind::kPrimary), 0U);
  EXPECT_EQ(disagreements(image, random_rays(50000), RayKind::kShadow), 0U);
}

TEST(EmbreeTracer, ResolvesEqualDistancesLikeBvhTracer) {
  Scene scene = triangle_soup(500, 0.4F);
  scene.instances.resize(4, scene.instances[0]);
  EXPECT_EQ(disagreements(build_memory_image(scene), random_rays(20000), RayKind::kPrimary), 0U);

  // Coplanar floors with different triangulations, seen at all angles.
  Mesh floors;
  Dice dice(5);
  for (std::uint32_t i = 0; i < 300; ++i) {
    for (int corner = 0; corner < 3; ++corner)
      floors.positions.emplace_back(dice.between(-1, 1), 0.1F, dice.between(-1, 1));
    floors.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  EXPECT_EQ(disagreements(build_memory_image(scene_of(floors)), random_rays(20000), RayKind::kPrimary), 0U);
}

TEST(EmbreeTracer, CoversOneTriangleAndNone) {
  EXPECT_EQ(disagreements(build_memory_image(one_triangle()), random_rays(1000), RayKind::kPrimary), 0U);
  EXPECT_EQ(disagreements(build_memory_image(Scene{}), random_rays(100), RayKind::kPrimary), 0U);
}

TEST(EmbreeTracer, NamesItsVersion) { EXPECT_EQ(embree_version().find_first_not_of("0123456789."), std::string::npos); }

#if defined(__SSE__)
TEST(EmbreeTracer, KeepsTheFloatingPointModeOfItsCaller) {
  const unsigned before = _mm_getcsr();
  const MemoryImage image = build_memory_image(triangle_soup(5000, 0.2F), {}, 2);
  trace(EmbreeTracer(image, 2), random_rays(1000));
  // The lower six bits are exception flags.
  EXPECT_EQ(_mm_getcsr() & ~0x3fU, before & ~0x3fU);
}
#endif

}  // namespace
}  // namespace traces
