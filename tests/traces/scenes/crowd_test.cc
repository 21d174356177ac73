#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "traces/scene/animation.h"
#include "traces/scene/bounds.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/shapes.h"

namespace test {
namespace {

using traces::Bounds;
using traces::Mesh;
using traces::Scene;

Bounds bounds_of(const Mesh& mesh) {
  Bounds bounds;
  for (const glm::vec3& p : mesh.positions) bounds.add(p);
  return bounds;
}

TEST(Crowd, HasTwoHundredSkinnedFiguresWithASkeletonEach) {
  const Scene scene = traces::build_scene("crowd");
  EXPECT_NEAR(static_cast<double>(traces::count_triangles(scene)), 200'000, 0.05 * 200'000);
  std::size_t figures = 0;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.deformation == nullptr) continue;
    EXPECT_EQ(mesh.deformation->skin, figures++);
    const traces::Skin& skin = scene.skins.at(mesh.deformation->skin);
    ASSERT_EQ(mesh.deformation->joints.size(), mesh.positions.size());
    ASSERT_EQ(mesh.deformation->weights.size(), mesh.positions.size());
    for (const auto& joints : mesh.deformation->joints) ASSERT_LT(std::ranges::max(joints), skin.joints.size());
    for (const glm::vec4& w : mesh.deformation->weights) ASSERT_FLOAT_EQ(w.x + w.y + w.z + w.w, 1);
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), 1000, 60);
  }
  EXPECT_EQ(figures, 200U);
  EXPECT_EQ(scene.skins.size(), 200U);
}

TEST(Crowd, HasAboutTheRequestedNumberOfTriangles) {
  for (const std::uint32_t wanted : {100'000U, 400'000U}) {
    const Scene scene = traces::build_scene("crowd", {.triangles = wanted});
    EXPECT_NEAR(static_cast<double>(traces::count_triangles(scene)) / wanted, 1, 0.25);
  }
}

TEST(Crowd, WalksWithFeetOnTheGround) {
  Scene scene = traces::build_scene("crowd", {.triangles = 50'000});
  std::vector<Bounds> before;
  for (const Mesh& mesh : scene.meshes) before.push_back(bounds_of(mesh));
  for (const double seconds : {0.25, 1.0, 3.6}) {
    EXPECT_TRUE(traces::pose_scene(scene, seconds).geometry);
    int ahead = 0;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
      const Mesh& mesh = scene.meshes[i];
      if (mesh.deformation == nullptr) continue;
      const Bounds now = bounds_of(mesh);
      const float moved = now.centre().x - before[i].centre().x;
      EXPECT_NEAR(std::abs(moved), 1.35 * seconds, 0.3) << seconds;
      ahead += moved > 0 ? 1 : 0;
      EXPECT_NEAR(now.centre().z, before[i].centre().z, 0.1);
      EXPECT_GT(now.lower.y, -0.03F);
      EXPECT_LT(now.lower.y, 0.12F);
      EXPECT_NEAR(now.upper.y, 1.73, 0.04);
      for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-4);
    }
    EXPECT_EQ(ahead, 100);
  }
}

TEST(Crowd, DoesNotStepInTime) {
  const Scene scene = traces::build_scene("crowd", {.triangles = 50'000});
  // The distance between the feet shows the phase of a stride.
  std::vector<float> lengths;
  for (const Mesh& mesh : scene.meshes) {
    if (mesh.deformation != nullptr) lengths.push_back(bounds_of(mesh).upper.x - bounds_of(mesh).lower.x);
  }
  EXPECT_GT(std::ranges::max(lengths) - std::ranges::min(lengths), 0.2F);
}

TEST(Crowd, StaysOnTheSquare) {
  Scene scene = traces::build_scene("crowd", {.triangles = 50'000});
  const Bounds square = bounds_of(scene.meshes[0]);
  for (double seconds = 0; seconds <= traces::animation_seconds(scene); seconds += 1) {
    traces::pose_scene(scene, seconds);
    const Bounds all = traces::world_bounds(scene);
    EXPECT_EQ(all.lower.x, square.lower.x);
    EXPECT_EQ(all.upper.x, square.upper.x);
    EXPECT_EQ(all.lower.z, square.lower.z);
    EXPECT_EQ(all.upper.z, square.upper.z);
  }
}

}  // namespace
}  // namespace test
