#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "support.h"
#include "tests/param_name.h"
#include "tests/real_scenes.h"
#include "traces/accel/build.h"
#include "traces/accel/bvh_tracer.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"
#include "traces/scene/gltf.h"

// Tests of animated scenes with rebuilt and with refitted trees, compared with Embree.

namespace traces {
namespace {

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
