#include <cmath>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "tests/traces/scene/pose/moving_scene.h"
#include "traces/scene/pose.h"

// Tests of meshes that skins and morph targets deform.

namespace traces {
namespace {

using Path = Track::Path;

/// Returns a strip of two triangles along x. Joint 1 (node 2), a child of node 1 at x = 1, moves its end at x = 2.
Scene bending_strip() {
  Scene scene = one_node();
  scene.nodes.resize(3);
  scene.nodes[2].parent = 1;
  scene.nodes[2].rest.translation = {1, 0, 0};
  scene.skins.push_back({{1, 2}, {glm::mat4(1), glm::translate(glm::mat4(1), {-1, 0, 0})}});
  Deformation rest;
  rest.positions = {{0, 0, 0}, {0, 0, 1}, {2, 0, 0}, {2, 0, 1}, {1, 0, 0}};
  rest.normals.assign(5, {0, 1, 0});
  rest.tangents.assign(5, {1, 0, 0, -1});
  rest.joints = {{0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}};
  rest.weights = {{1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 0}, {0.5F, 0.5F, 0, 0}};
  rest.skin = 0;
  Mesh& mesh = scene.meshes[0];
  mesh.positions = rest.positions;
  mesh.normals = rest.normals;
  mesh.tangents = rest.tangents;
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  mesh.deformation = std::make_shared<Deformation>(std::move(rest));
  return scene;
}

void expect_near(const glm::vec3& found, const glm::vec3& expected) {
  EXPECT_LT(glm::length(found - expected), 1e-6F) << found.x << ' ' << found.y << ' ' << found.z;
}

TEST(Skins, AtRestShowTheBindPose) {
  Scene scene = bending_strip();
  const Mesh before = scene.meshes[0];
  EXPECT_FALSE(pose_scene(scene, 0).geometry);
  EXPECT_EQ(scene.meshes[0].positions, before.positions);
  EXPECT_EQ(scene.meshes[0].normals, before.normals);
}

TEST(Skins, VerticesFollowTheirJoints) {
  Scene scene = bending_strip();
  const float half = std::sqrt(0.5F);
  scene.tracks = {track_of(Path::kRotation, {0}, {0, 0, half, half})};  // the end turns up around (1, 0, 0)
  scene.tracks[0].node = 2;
  EXPECT_TRUE(pose_scene(scene, 0).geometry);
  const Mesh& mesh = scene.meshes[0];
  expect_near(mesh.positions[1], {0, 0, 1});
  expect_near(mesh.positions[3], {1, 1, 1});
  expect_near(mesh.normals[3], {-1, 0, 0});
  expect_near(glm::vec3(mesh.tangents[3]), {0, 1, 0});
  EXPECT_EQ(mesh.tangents[3].w, -1);
  expect_near(mesh.positions[4], {1, 0, 0});
  expect_near(mesh.normals[4], {-half, half, 0});
}

TEST(Skins, TheNodeThatShowsTheMeshDoesNotCount) {
  Scene scene = bending_strip();
  scene.tracks = {track_of(Path::kTranslation, {0}, {7, 7, 7})};
  pose_scene(scene, 0);
  EXPECT_EQ(scene.instances[0].to_world, glm::mat4(1));
  expect_near(scene.meshes[0].positions[3], {2, 0, 1});
}

TEST(MorphTargets, AddUpByTheirWeightsAndNormalsStayUnit) {
  Scene scene = one_node();
  Deformation rest;
  rest.positions = scene.meshes[0].positions;
  rest.normals.assign(3, {0, 0, 1});
  rest.target_positions = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  rest.target_normals = {{{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {}};
  scene.meshes[0].deformation = std::make_shared<Deformation>(std::move(rest));
  scene.nodes[0].morph_weights = {0, 0.25F};
  pose_scene(scene, 0);
  expect_near(scene.meshes[0].positions[0], {0.25F, 0, 0});
  scene.tracks = {track_of(Path::kMorphWeights, {0, 1}, {0, 0, 1, -1})};
  pose_scene(scene, 1);
  expect_near(scene.meshes[0].positions[0], {-1, 0, 1});
  expect_near(scene.meshes[0].normals[0], {std::sqrt(0.5F), 0, std::sqrt(0.5F)});
  pose_scene(scene, 0.5);
  expect_near(scene.meshes[0].positions[0], {-0.5F, 0, 0.5F});
}

TEST(MorphTargets, FlatNormalsAreThoseOfTheMovedTriangle) {
  Scene scene = one_node();
  Deformation rest;
  rest.positions = scene.meshes[0].positions;
  rest.target_positions = {{{0, 0, 0}, {-1, 0, 1}, {0, 0, 0}}};  // (1, 0, 0) to (0, 0, 1)
  scene.meshes[0].deformation = std::make_shared<Deformation>(std::move(rest));
  scene.nodes[0].morph_weights = {1};
  pose_scene(scene, 0);
  for (const glm::vec3& normal : scene.meshes[0].normals) expect_near(normal, {-1, 0, 0});
}

}  // namespace
}  // namespace traces
