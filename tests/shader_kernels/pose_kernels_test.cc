#include "shader_kernels/programs/pose_kernels.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "shader_kernels/kernels/pose.h"
#include "traces/accel/build.h"
#include "traces/scene/animation.h"
#include "traces/scene/pose.h"
#include "traces/scenes/library.h"

// Tests of the kernels that move geometry to the pose of a frame.

namespace kernels {
namespace {

Vec3<float> vec3_of(const auto& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
MatrixRecord<float> matrix_of(const auto& m) { return {vec3_of(m[0]), vec3_of(m[1]), vec3_of(m[2]), vec3_of(m[3])}; }

double distance(const Vec3<float>& a, const glm::vec3& b) {
  return std::hypot(static_cast<double>(a.x - b.x), static_cast<double>(a.y - b.y), static_cast<double>(a.z - b.z));
}

TEST(PoseKernels, SkinVerticesAsTheHostDoes) {
  traces::Scene scene = traces::open_scene("crowd", {.triangles = 10000});
  constexpr double kSeconds = 1.3;
  ASSERT_TRUE(traces::pose_scene(scene, kSeconds).geometry);
  const traces::NodePoses nodes = traces::pose_nodes(scene, kSeconds);
  std::size_t skinned = 0;
  for (const traces::Mesh& mesh : scene.meshes) {
    if (mesh.deformation == nullptr) continue;
    const traces::Deformation& rest = *mesh.deformation;
    const traces::Skin& skin = scene.skins[rest.skin];
    std::vector<MatrixRecord<float>> joints;
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      joints.push_back(matrix_of(nodes.to_world[skin.joints[j]] * glm::dmat4(skin.inverse_bind[j])));
    }
    for (std::size_t v = 0; v < rest.positions.size(); ++v) {
      PointRecord<float> at{vec3_of(rest.positions[v])}, posed{};
      const auto [j0, j1, j2, j3] = rest.joints[v];
      const glm::vec4 w = rest.weights[v];
      SkinRecord<float> weights{std::uint32_t{j0} | std::uint32_t{j1} << 16,
                                std::uint32_t{j2} | std::uint32_t{j3} << 16,
                                w[0],
                                w[1],
                                w[2],
                                w[3]};
      SkinVertex::Ports<float> ports;
      ports.rest.bind(&at);
      ports.skin.bind(&weights);
      ports.joints.bind(joints.data());
      ports.posed.bind(&posed);
      SkinVertex::body<float>(0U, ports);
      EXPECT_LT(distance(posed.at, mesh.positions[v]), 1e-4) << v;
      skinned += 1;
    }
  }
  EXPECT_EQ(skinned, traces::pose_work(scene, traces::InstanceLevels::kFlatten).skinned_vertices);
  EXPECT_GT(skinned, 1000U);
}

TEST(PoseKernels, MoveVerticesOfRigidMeshes) {
  PointRecord<float> rest{{1, 2, 3}}, posed{};
  PoseVertex::Ports<float> ports;
  ports.rest.bind(&rest);
  ports.posed.bind(&posed);
  ports.to_world_x = {0, 2, 0};
  ports.to_world_y = {-3, 0, 0};
  ports.to_world_z = {0, 0, 4};
  ports.to_world_origin = {10, 20, 30};
  PoseVertex::body<float>(0U, ports);
  EXPECT_LT(distance(posed.at, {4, 22, 42}), 1e-6);
}

/// An instance of an image in two levels, for kernels.
PosedInstanceRecord<float> instance_of(const traces::Instance& instance, const traces::InstanceRecord& host) {
  const MatrixRecord<float> m = matrix_of(instance.to_world);
  return {m.x, m.y, m.z, m.origin, host.root, host.object};
}

TEST(PoseKernels, WriteTheInstancesOfTheHost) {
  const traces::Scene scene = traces::open_scene("forest", {.triangles = 20000});
  traces::BvhConfig bvh;
  bvh.instances = traces::InstanceLevels::kTwoLevel;
  const traces::MemoryImage image = traces::build_memory_image(scene, bvh, 1);
  ASSERT_GT(image.instances.size(), 10U);
  std::vector<BoxRecord<float>> boxes(image.instances.size());
  for (std::size_t i = 0; i < image.instances.size(); ++i) {
    const traces::InstanceRecord& host = image.instances[i];
    PosedInstanceRecord<float> moved = instance_of(scene.instances[i], host);
    traces::InstanceRecord encoded{};
    PoseInstance::Ports<float> ports;
    ports.moved.bind(&moved);
    ports.encoded.base = reinterpret_cast<std::byte*>(&encoded);
    PoseInstance::body<float>(0U, ports);
    float largest = 0;
    for (const auto& row : host.to_object) {
      for (const float x : row) largest = std::max(largest, std::abs(x));
    }
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 4; ++c)
        EXPECT_NEAR(encoded.to_object[r][c], host.to_object[r][c], 1e-5F * largest) << i;
    }
    EXPECT_EQ(encoded.root, host.root);
    EXPECT_EQ(encoded.object, host.object);
    EXPECT_EQ(encoded.handedness, host.handedness);
    EXPECT_NEAR(encoded.volume, host.volume, 1e-5F * host.volume);
  }
}

TEST(PoseKernels, BoundInstancesInTheWorld) {
  PosedInstanceRecord<float> moved{{0, 2, 0}, {-3, 0, 0}, {0, 0, 4}, {10, 20, 30}, 0, 0};
  BoxRecord<float> mesh{{-1, 0, 1}, {1, 2, 3}}, box{};
  BoundInstance::Ports<float> ports;
  ports.moved.bind(&moved);
  ports.meshes.bind(&mesh);
  ports.boxes.bind(&box);
  BoundInstance::body<float>(0U, ports);
  EXPECT_LT(distance(box.lower, {4, 18, 34}), 1e-6);
  EXPECT_LT(distance(box.upper, {10, 22, 42}), 1e-6);
}

TEST(PoseKernels, MoveTheBytesOfTheClosedForms) {
  KernelPasses passes(64 * 1024, 0);
  add_pose_passes({.skinned_vertices = 10000, .joints = 40, .rigid_vertices = 7000, .rigid_instances = 3}, passes);
  ASSERT_EQ(passes.passes().size(), 2U);
  EXPECT_EQ(passes.passes()[0].moved_bytes(), 10000 * (12 + 24 + 12) + 40 * 48U);
  EXPECT_EQ(passes.passes()[1].moved_bytes(), 7000 * (12 + 12) + 3 * 48U);
}

TEST(PoseKernels, MoveOnlyAnimatedGeometry) {
  const traces::Scene crowd = traces::open_scene("crowd", {.triangles = 10000});
  const traces::PoseWork skins = traces::pose_work(crowd, traces::InstanceLevels::kTwoLevel);
  EXPECT_GT(skins.joints, 0U);
  EXPECT_EQ(skins.rigid_vertices, 0U);
  const traces::Scene car = traces::open_scene("car", {.triangles = 3000});
  const traces::PoseWork flat = traces::pose_work(car, traces::InstanceLevels::kFlatten);
  const traces::PoseWork levels = traces::pose_work(car, traces::InstanceLevels::kTwoLevel);
  EXPECT_GT(flat.rigid_vertices, 100U);
  EXPECT_GT(flat.rigid_instances, 0U);
  EXPECT_LT(flat.rigid_instances, car.instances.size()) << "the floor does not move";
  EXPECT_EQ(levels, traces::PoseWork{});
  EXPECT_EQ(traces::pose_work(traces::open_scene("cornell"), traces::InstanceLevels::kFlatten), traces::PoseWork{});
}

}  // namespace
}  // namespace kernels
