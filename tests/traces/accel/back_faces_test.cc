#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "support.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"
#include "traces/walk.h"

// Tests that rays pass through back faces of single-sided materials in BvhTracer, Embree and exact_hit().

namespace traces {
namespace {

constexpr std::array kInstanceLevels{InstanceLevels::kFlatten, InstanceLevels::kTwoLevel};

/// A ray that hits the middle of one_triangle(), which faces +z.
const Ray kFromFront{{0.25F, 0.25F, 1}, 0, {0, 0, -1}};
const Ray kFromBack{{0.25F, 0.25F, -1}, 0, {0, 0, 1}};

/// Returns, for every tracer, if a ray from the front hits and if one from the back hits.
std::vector<bool> seen(const Scene& scene, InstanceLevels instances, RayKind kind) {
  const MemoryImage image = build_memory_image(scene, {.instances = instances}, 1);
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  std::vector<bool> hits;
  for (const Ray& ray : {kFromFront, kFromBack}) {
    hits.push_back(trace(bvh, {ray}, kind)[0].is_hit());
    EXPECT_EQ(trace(embree, {ray}, kind)[0].is_hit(), hits.back());
  }
  return hits;
}

TEST(BackFaces, AreHitUnlessTheMaterialIsSingleSided) {
  for (const InstanceLevels levels : kInstanceLevels) {
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
      EXPECT_EQ(seen(one_triangle(), levels, kind), (std::vector{true, true}));
      EXPECT_EQ(seen(single_sided(one_triangle()), levels, kind), (std::vector{true, false}));
    }
  }
}

/// glTF: a transform with a negative determinant reverses the winding of front faces.
TEST(BackFaces, OfMirroredInstancesStayBackFaces) {
  for (const InstanceLevels levels : kInstanceLevels) {
    Scene scene = single_sided(one_triangle());
    scene.instances[0].to_world = glm::translate(glm::scale(glm::mat4(1), {-1, 1, 1}), {-1, 0, 0});
    EXPECT_EQ(seen(scene, levels, RayKind::kPrimary), (std::vector{true, false}));
    scene.instances[0].to_world = glm::scale(glm::mat4(1), {1, 1, -1});
    EXPECT_EQ(seen(scene, levels, RayKind::kPrimary), (std::vector{false, true}));
    scene.instances[0].to_world = glm::scale(glm::mat4(1), {1, 1, 0});
    EXPECT_EQ(seen(scene, levels, RayKind::kPrimary), (std::vector{true, false})) << "flat";
  }
}

TEST(BackFaces, OfMaterialsThatTransmitAreHit) {
  Scene scene = single_sided(one_triangle());
  scene.materials[0].transmission = 0.5F;
  EXPECT_EQ(seen(scene, InstanceLevels::kFlatten, RayKind::kPrimary), (std::vector{true, true}));
}

TEST(BackFaces, EndATestInItsFirstPhase) {
  const MemoryImage image = build_memory_image(single_sided(one_triangle()), {}, 1);
  const auto phases = [&](const Ray& ray) {
    Hit hit;
    std::vector<std::uint32_t> words, begin;
    WalkSink sink{words, begin};
    BvhTracer(image).trace({&ray, 1}, RayKind::kPrimary, {&hit, 1}, &sink);
    return words.at(words.size() - 2);  // phases of the leaf, before the walk's end
  };
  EXPECT_EQ(phases(kFromBack) & 3U, 1U);
  EXPECT_EQ(phases(kFromFront) & 3U, 3U);
}

TEST(BackFaces, OfASphereAreHitOnlyFromWithin) {
  const MemoryImage image = build_memory_image(single_sided(sphere(16, 16)), {}, 1);
  const std::vector<Ray> rays{{{0, 0.1F, 0.2F}, 0, {1, 0, 0}}, {{-3, 0.1F, 0.2F}, 0, {1, 0, 0}}};
  const std::vector<Hit> hits = trace(BvhTracer(image), rays);
  EXPECT_FALSE(hits[0].is_hit());
  EXPECT_NEAR(hits[1].t, 2.03F, 0.02F) << "the nearer side";
}

TEST(BackFaces, GiveTheSameHitsWithAnyTree) {
  for (const InstanceLevels levels : kInstanceLevels) {
    for (const Scene& scene : {single_sided(triangle_soup(1000, 0.3F)), single_sided(scattered(40))}) {
      const MemoryImage image = build_memory_image(scene, {.instances = levels}, 1);
      const std::vector<Ray> rays = random_rays(1500);
      std::vector<Hit> expected;
      for (const Ray& ray : rays) expected.push_back(test_all(image, ray));
      EXPECT_EQ(count_different(trace(BvhTracer(image), rays), expected), 0U);
      EXPECT_EQ(count_different_in_portable(image, rays), 0U);
    }
  }
}

TEST(BackFaces, AreTheSameForEmbreeAndTheEquations) {
  for (const InstanceLevels levels : kInstanceLevels) {
    for (const Scene& scene : {single_sided(triangle_soup(800, 0.3F)), single_sided(scattered(40)),
                               single_sided(with_transparent_triangles(triangle_soup(800, 0.3F)))}) {
      const MemoryImage image = build_memory_image(scene, {.instances = levels}, 1);
      const BvhTracer bvh(image);
      const EmbreeTracer embree(image, 1);
      for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
        const VerifyingTracer verifying(image, bvh, embree);
        trace(verifying, random_rays(20000), kind);
        EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
        EXPECT_EQ(verifying.verify_counts().reference_errors, 0U);
      }
    }
  }
}

TEST(BackFaces, AreMissedByTheEquations) {
  const MemoryImage both = build_memory_image(triangle_soup(800, 0.3F), {}, 1);
  const MemoryImage front = build_memory_image(single_sided(triangle_soup(800, 0.3F)), {}, 1);
  const BvhTracer wrong(both);
  const EmbreeTracer embree(front, 1);
  const VerifyingTracer verifying(front, wrong, embree);
  trace(verifying, random_rays(3000));
  EXPECT_GT(verifying.verify_counts().error_count(), 100U) << "a tracer that hits back faces is found out";
}

}  // namespace
}  // namespace traces
