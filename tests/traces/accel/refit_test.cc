#include <cmath>
#include <cstring>
#include <filesystem>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "support.h"
#include "tests/param_name.h"
#include "tests/real_scenes.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_info.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"
#include "traces/scene/gltf.h"

namespace traces {
namespace {

void expect_same(const MemoryImage& a, const MemoryImage& b) {
  EXPECT_TRUE(same_bytes(a.nodes, b.nodes));
  EXPECT_TRUE(same_bytes(a.triangles, b.triangles));
  EXPECT_TRUE(same_bytes(a.attributes, b.attributes));
  EXPECT_TRUE(same_bytes(a.vertices, b.vertices));
  EXPECT_EQ(std::memcmp(&a.lower, &b.lower, sizeof a.lower), 0);
  EXPECT_EQ(std::memcmp(&a.upper, &b.upper, sizeof a.upper), 0);
  EXPECT_EQ(a.layout.end, b.layout.end);
}

/// Returns the scene with every vertex moved by up to `far` along each axis, and then rotated and scaled.
Scene moved_by_dice(Scene scene, float far, std::uint64_t seed = 7) {
  Dice dice(seed);
  for (Mesh& mesh : scene.meshes) {
    for (glm::vec3& p : mesh.positions) p += dice.point(-far, far);
  }
  for (Instance& instance : scene.instances) {
    instance.to_world = glm::scale(glm::rotate(glm::mat4(1), 1.0F, {1, 2, 3}), {1.2F, -0.7F, 1});
  }
  return scene;
}

/// Returns a scene with optional records per triangle.
Scene coloured_soup() {
  Scene scene = triangle_soup(500, 0.1F);
  scene.materials.resize(1);
  Mesh& mesh = scene.meshes[0];
  mesh.tangents.assign(mesh.positions.size(), {0, 0, 1, 1});
  Dice dice(5);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.colours.emplace_back(dice.point(0, 1), 1);
  return scene;
}

/// Returns scenes of normal triangles, of triangles without area (a line or a point), and with zeros of both signs.
std::vector<Scene> scenes() {
  Scene signs = grid_soup(500);
  signs.instances[0].to_world = glm::scale(glm::translate(glm::mat4(1), {-0.0F, -0.0F, -0.0F}), {-1, 1, -1});
  return {triangle_soup(5000, 0.1F), grid_soup(3000), sphere(20, 30), coloured_soup(), one_triangle(), signs, Scene{}};
}

TEST(Refit, OfAnUnmovedSceneChangesNoBit) {
  for (const Scene& scene : scenes()) {
    const MemoryImage built = build_memory_image(scene);
    MemoryImage refitted = built;
    refit_memory_image(scene, refitted);
    expect_same(built, refitted);
  }
}

TEST(Refit, DependsOnlyOnTheLastPose) {
  for (const Scene& scene : scenes()) {
    MemoryImage once = build_memory_image(scene), often = once;
    const Scene there = moved_by_dice(scene, 0.3F);
    refit_memory_image(there, once);
    for (const float far : {1.0F, 0.0F, 5.0F}) refit_memory_image(moved_by_dice(scene, far, 9), often);
    refit_memory_image(there, often);
    expect_same(once, often);
    refit_memory_image(scene, often);
    expect_same(build_memory_image(scene), often);
  }
}

TEST(Refit, HitsWhatARebuiltTreeHits) {
  for (const Scene& scene : {triangle_soup(3000, 0.1F), grid_soup(1000)}) {
    MemoryImage refitted = build_memory_image(scene);
    const Scene there = moved_by_dice(scene, 0.2F);
    refit_memory_image(there, refitted);
    const MemoryImage rebuilt = build_memory_image(there);
    EXPECT_EQ(refitted.lower, rebuilt.lower);
    EXPECT_EQ(refitted.upper, rebuilt.upper);
    const std::vector<Ray> rays = random_rays(20000);
    for (const RayKind kind : {RayKind::kPrimary, RayKind::kShadow}) {
      const std::vector<Hit> a = trace(BvhTracer(refitted), rays, kind), b = trace(BvhTracer(rebuilt), rays, kind);
      std::size_t hits = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(a[i].is_hit(), b[i].is_hit()) << i;
        hits += a[i].is_hit();
        if (!a[i].is_hit() || kind == RayKind::kShadow) continue;
        ASSERT_EQ(a[i].t, b[i].t) << i;
        ASSERT_EQ(refitted.triangles[a[i].triangle].source, rebuilt.triangles[b[i].triangle].source) << i;
      }
      EXPECT_GT(hits, 1000U);
    }
  }
}

TEST(Refit, AgreesWithEmbreeOnTheMovedTriangles) {
  const Scene scene = triangle_soup(3000, 0.1F);
  MemoryImage image = build_memory_image(scene);
  refit_memory_image(moved_by_dice(scene, 0.5F), image);
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const VerifyingTracer verifying(image, bvh, embree);
  trace(verifying, random_rays(50000));
  EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
}

TEST(Refit, CostsMoreTheFurtherThingsMove) {
  const Scene scene = triangle_soup(5000, 0.05F);
  MemoryImage image = build_memory_image(scene);
  const double built = bvh_info(image).sah_cost;
  refit_memory_image(moved_by_dice(scene, 0.1F), image);
  const double near = bvh_info(image).sah_cost;
  refit_memory_image(moved_by_dice(scene, 1), image);
  const double far = bvh_info(image).sah_cost;
  EXPECT_LT(built, near);
  EXPECT_LT(near, far);
  EXPECT_LT(bvh_info(build_memory_image(moved_by_dice(scene, 1))).sah_cost, far);
}

TEST(Refit, KeepsTheTreeTheMaterialsAndAllAddresses) {
  const Scene scene = triangle_soup(1000, 0.1F);
  const MemoryImage built = build_memory_image(scene);
  MemoryImage image = built;
  refit_memory_image(moved_by_dice(scene, 1), image);
  for (std::size_t i = 0; i < built.nodes.size(); ++i) {
    EXPECT_EQ(image.nodes[i].child[0], built.nodes[i].child[0]);
    EXPECT_EQ(image.nodes[i].child[1], built.nodes[i].child[1]);
  }
  for (std::size_t i = 0; i < built.triangles.size(); ++i) {
    EXPECT_EQ(image.triangles[i].source, built.triangles[i].source);
  }
  EXPECT_EQ(image.layout.attributes, built.layout.attributes);
  EXPECT_EQ(image.layout.end, built.layout.end);
}

TEST(Refit, CopiesLightsAndShrinksFlatTrianglesToAPoint) {
  Scene scene = one_triangle();
  scene.lights.emplace_back();
  MemoryImage image = build_memory_image(scene);
  scene.lights[0].position = {1, 2, 3};
  scene.meshes[0].positions = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}};
  refit_memory_image(scene, image);
  EXPECT_EQ(image.lights[0].position, glm::vec3(1, 2, 3));
  EXPECT_EQ(image.triangles[0].v2, glm::vec3(1, 1, 1));
  EXPECT_EQ(image.upper, glm::vec3(1, 1, 1));
  scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  refit_memory_image(scene, image);
  EXPECT_EQ(image.triangles[0].v1, glm::vec3(1, 0, 0)) << "it comes back";
}

// Tests of animated scenes with rebuilt and with refitted trees, compared with Embree.

std::vector<Ray> camera_rays(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const float up = std::tan(camera.vertical_fov / 2),
              right = up * static_cast<float>(width) / static_cast<float>(height);
  std::vector<Ray> rays(std::size_t{width} * height);
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    const float x = (static_cast<float>(i % width) + 0.5F) / static_cast<float>(width) * 2 - 1;
    const float y = 1 - (static_cast<float>(i / width) + 0.5F) / static_cast<float>(height) * 2;
    rays[i].origin = glm::vec3(camera.to_world[3]);
    rays[i].direction = glm::normalize(glm::vec3(camera.to_world * glm::vec4(x * right, y * up, -1, 0)));
  }
  return rays;
}

/// Returns rays in random directions from the hits of others.
std::vector<Ray> bounced(const std::vector<Ray>& rays, const std::vector<Hit>& hits, std::uint64_t seed) {
  Dice dice(seed);
  std::vector<Ray> out;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!hits[i].is_hit()) continue;
    Ray& ray = out.emplace_back();
    ray.origin = rays[i].origin + hits[i].t * rays[i].direction;
    ray.direction = dice.direction();
    ray.t_min = 1e-3F;
  }
  return out;
}

void expect_no_faults(const MemoryImage& image, const Camera& camera, std::uint64_t seed) {
  const BvhTracer bvh(image);
  const EmbreeTracer embree(image, 1);
  const VerifyingTracer verifying(image, bvh, embree);
  const std::vector<Ray> rays = camera_rays(camera, 96, 64);
  const std::vector<Ray> further = bounced(rays, trace(verifying, rays), seed);
  EXPECT_GT(further.size(), rays.size() / 50) << "the camera looks past everything";
  trace(verifying, further, RayKind::kReflection);
  trace(verifying, further, RayKind::kShadow);
  const VerifyCounts counts = verifying.verify_counts();
  EXPECT_EQ(counts.missing_hits, 0U);
  EXPECT_EQ(counts.extra_hits, 0U);
  EXPECT_EQ(counts.distance_errors, 0U);
}

class MovingScene : public ::testing::TestWithParam<const char*> {};

TEST_P(MovingScene, IsHitAsEmbreeHitsItAtAnyTime) {
  const std::filesystem::path file = test::scenes_folder() / GetParam();
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "no " << file << "; set RAYWATT_SCENES to a folder that has it";
  }
  Scene scene = load_gltf(file);
  ASSERT_GT(animation_seconds(scene), 0);
  MemoryImage refitted = build_memory_image(scene);
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    pose_scene(scene, animation_seconds(scene) * (i + 0.37) / 8);
    refit_memory_image(scene, refitted);
    expect_no_faults(refitted, scene.cameras[0], static_cast<std::uint64_t>(i));
    expect_no_faults(build_memory_image(scene), scene.cameras[0], static_cast<std::uint64_t>(i));
  }
}

INSTANTIATE_TEST_SUITE_P(Files, MovingScene, ::testing::Values("hotel-room-animated.glb", "cesium-man-skinned-5k.glb"),
                         ::test::ParamName());

}  // namespace
}  // namespace traces
