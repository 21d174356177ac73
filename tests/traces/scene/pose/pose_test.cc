#include "traces/scene/pose.h"

#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/pose/moving_scene.h"
#include "traces/scene/scene.h"

namespace traces {
namespace {

using Path = Track::Path;
using Interpolation = Track::Interpolation;

std::array<double, 4> at(const Track& track, double seconds) {
  std::array<double, 4> out{};
  sample_track(track, seconds, std::span(out).first(track.path == Path::kRotation ? 4 : 3));
  return out;
}

double x_at(const Track& track, double seconds) { return at(track, seconds)[0]; }

TEST(Tracks, StandStillBeforeTheFirstAndAfterTheLastKey) {
  for (const auto interpolation : {Interpolation::kStep, Interpolation::kLinear}) {
    const Track track = track_of(Path::kTranslation, {1, 2}, {5, 0, 0, 7, 0, 0}, interpolation);
    EXPECT_EQ(x_at(track, -3), 5);
    EXPECT_EQ(x_at(track, 1), 5);
    EXPECT_EQ(x_at(track, 2), 7);
    EXPECT_EQ(x_at(track, 1e9), 7);
  }
}

TEST(Tracks, StepHoldsAKeyUntilTheNextOne) {
  const Track track = track_of(Path::kTranslation, {0, 1}, {5, 0, 0, 7, 0, 0}, Interpolation::kStep);
  EXPECT_EQ(x_at(track, 0.999), 5);
  EXPECT_EQ(x_at(track, 1), 7);
}

TEST(Tracks, LinearGoesEvenlyFromKeyToKey) {
  const Track track = track_of(Path::kScale, {0, 1, 3}, {5, 0, 0, 7, 0, 0, 3, 0, 0});
  EXPECT_DOUBLE_EQ(x_at(track, 0.25), 5.5);
  EXPECT_DOUBLE_EQ(x_at(track, 2.5), 4);
}

TEST(Tracks, KeysOfOneTimeAreAJump) {
  const Track track = track_of(Path::kTranslation, {0, 1, 1, 2}, {0, 0, 0, 1, 0, 0, 10, 0, 0, 11, 0, 0});
  EXPECT_DOUBLE_EQ(x_at(track, 0.999), 0.999);
  EXPECT_DOUBLE_EQ(x_at(track, 1), 10);
}

TEST(Tracks, ACubicSplineLeavesAndEntersAKeyAlongItsTangents) {
  // From 1 with slope 2 to 4 with slope -1, in 2 seconds: glTF's Hermite formula.
  const Track track = track_of(Path::kTranslation, {1, 3}, {9, 0, 0, 1, 0, 0, 2, 0, 0, -1, 0, 0, 4, 0, 0, 9, 0, 0},
                               Interpolation::kCubicSpline);
  EXPECT_DOUBLE_EQ(x_at(track, 0), 1);
  EXPECT_DOUBLE_EQ(x_at(track, 2), 0.5 * 1 + 0.125 * 2 * 2 + 0.5 * 4 - 0.125 * 2 * -1);
  EXPECT_DOUBLE_EQ(x_at(track, 3), 4);
  EXPECT_NEAR((x_at(track, 1.0001) - 1) / 0.0001, 2, 1e-3);
  EXPECT_NEAR((4 - x_at(track, 2.9999)) / 0.0001, -1, 1e-3);
}

TEST(Tracks, RotationsTurnEvenlyByTheSine) {
  for (const double angle : {1e-6, 0.01, 1.0, 2.0, 3.0}) {  // whole angle of the rotation around z
    const auto half_sine = static_cast<float>(std::sin(angle / 2)),
               half_cosine = static_cast<float>(std::cos(angle / 2));
    const Track track = track_of(Path::kRotation, {0, 1}, {0, 0, 0, 1, 0, 0, half_sine, half_cosine});
    for (const double t : {0.0, 0.1, 0.25, 0.5, 0.9, 1.0}) {
      const auto q = at(track, t);
      const double exact = std::atan2(static_cast<double>(half_sine), static_cast<double>(half_cosine)) * t;
      EXPECT_NEAR(q[2], std::sin(exact), 1e-15) << angle << " at " << t;
      EXPECT_NEAR(q[3], std::cos(exact), 1e-15) << angle << " at " << t;
    }
  }
}

TEST(Tracks, RotationsTakeTheShorterWayRound) {
  const float half = std::sqrt(0.5F);
  const Track track = track_of(Path::kRotation, {0, 1}, {0, 0, 0, 1, 0, 0, -half, -half});  // 90 degrees, negated
  const auto q = at(track, 0.5);
  EXPECT_NEAR(q[2], std::sin(std::numbers::pi / 8), 1e-7);
  EXPECT_NEAR(q[3], std::cos(std::numbers::pi / 8), 1e-7);
}

TEST(Tracks, RotationsOnASplineAreMadeUnit) {
  const Track track = track_of(Path::kRotation, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0,  //
                                                         0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0},
                               Interpolation::kCubicSpline);
  const auto q = at(track, 0.5);
  EXPECT_NEAR(q[2], std::sqrt(0.5), 1e-15);
  EXPECT_NEAR(q[3], std::sqrt(0.5), 1e-15);
}

TEST(Pose, MovesWhatIsAttachedToANodeAndReportsIt) {
  Scene scene = one_node();
  pose_scene(scene, 0);
  scene.tracks = {track_of(Path::kTranslation, {0, 1}, {0, 0, 0, 4, 0, 0})};
  const Moved moved = pose_scene(scene, 0.5);
  EXPECT_TRUE(moved.geometry && moved.view && moved.lights);
  EXPECT_EQ(scene.instances[0].to_world, glm::translate(glm::mat4(1), {2, 0, 0}));
  EXPECT_EQ(scene.cameras[0].to_world, glm::translate(glm::mat4(1), {2, 0, 0}));
  EXPECT_EQ(scene.lights[0].position, glm::vec3(2, 0, 0));
  const Moved again = pose_scene(scene, 0.5);
  EXPECT_FALSE(again.geometry || again.view || again.lights);
}

TEST(Pose, ReportsIfOnlyTheCameraMoves) {
  Scene scene = one_node();
  scene.nodes.resize(2);
  scene.cameras[0].node = 1;
  scene.tracks = {track_of(Path::kTranslation, {0, 1}, {0, 0, 0, 4, 0, 0})};
  scene.tracks[0].node = 1;
  pose_scene(scene, 0);
  const Moved moved = pose_scene(scene, 1);
  EXPECT_TRUE(moved.view);
  EXPECT_FALSE(moved.geometry || moved.lights);
}

TEST(Pose, ChildrenFollowTheirParents) {
  Scene scene = one_node();
  scene.nodes.resize(3);
  scene.nodes[1].parent = 0;
  scene.nodes[1].matrix = glm::translate(glm::mat4(1), {1, 0, 0});
  scene.nodes[2].parent = 1;
  scene.nodes[2].rest.scale = glm::vec3(3);
  scene.instances[0].node = 2;
  const float half = std::sqrt(0.5F);
  scene.tracks = {track_of(Path::kRotation, {0}, {0, 0, half, half})};  // the root: 90 degrees around z
  pose_scene(scene, 0);
  const glm::vec4 corner = scene.instances[0].to_world * glm::vec4(1, 0, 0, 1);
  EXPECT_NEAR(corner.x, 0, 1e-6);
  EXPECT_NEAR(corner.y, 4, 1e-6);
}

TEST(Pose, TheFirstTrackForANodeAndPathCounts) {
  Scene scene = one_node();
  scene.tracks = {track_of(Path::kTranslation, {0}, {1, 0, 0}), track_of(Path::kTranslation, {0}, {2, 0, 0}),
                  track_of(Path::kScale, {0}, {3, 3, 3})};
  pose_scene(scene, 0);
  EXPECT_EQ(scene.instances[0].to_world[3][0], 1);
  EXPECT_EQ(scene.instances[0].to_world[0][0], 3);
}

TEST(Pose, DependsOnTheTimeAlone) {
  Scene scene = one_node();
  scene.tracks = {track_of(Path::kRotation, {0, 1, 2}, {0, 0, 0, 1, 0.6F, 0, 0, 0.8F, 0, 0.8F, 0, 0.6F}),
                  track_of(Path::kTranslation, {0, 2}, {0, -1, 3, 4, 5, 6})};
  Scene other = scene;
  pose_scene(scene, 1.3);
  for (const double seconds : {0.1, 1.9, -1.0, 0.7, 1.3}) pose_scene(other, seconds);
  EXPECT_EQ(scene.instances[0].to_world, other.instances[0].to_world);
  EXPECT_EQ(scene.cameras[0].to_world, other.cameras[0].to_world);
  EXPECT_EQ(scene.lights[0].position, other.lights[0].position);
  EXPECT_EQ(scene.lights[0].direction, other.lights[0].direction);
}

TEST(Pose, CamerasAreNotScaledAndLightsPointAhead) {
  Scene scene = one_node();
  scene.nodes[0].rest.scale = {2, 3, 4};
  scene.lights[0].in_node = glm::translate(glm::mat4(1), {0, 1, 0});
  const float half = std::sqrt(0.5F);
  scene.tracks = {track_of(Path::kRotation, {0}, {half, 0, 0, half})};  // 90 degrees around x: -z becomes +y
  pose_scene(scene, 0);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(glm::length(scene.cameras[0].to_world[axis]), 1, 1e-6);
  EXPECT_NEAR(scene.lights[0].direction.y, 1, 1e-6);
  EXPECT_NEAR(scene.lights[0].position.z, 3, 1e-6);
}

TEST(Pose, RefusesWhatGoesTooFarAway) {
  Scene scene = one_node();
  scene.tracks = {track_of(Path::kTranslation, {0, 1}, {0, 0, 0, 1e16F, 0, 0})};
  pose_scene(scene, 0);
  EXPECT_THROW(pose_scene(scene, 1), sim::InputError);
  scene.tracks[0].values[3] = 1e14F;
  EXPECT_NO_THROW(pose_scene(scene, 1));
  scene.meshes[0].positions[1].x = 100;  // 1e14 x 100
  EXPECT_THROW(pose_scene(scene, 0.5), sim::InputError);
}

TEST(Pose, LastsUntilTheLastKey) {
  Scene scene = one_node();
  EXPECT_EQ(animation_seconds(scene), 0);
  scene.tracks = {track_of(Path::kScale, {0, 1.5F}, {1, 1, 1, 1, 1, 1}), track_of(Path::kTranslation, {1}, {0, 0, 0})};
  EXPECT_EQ(animation_seconds(scene), 1.5);
}

// Tests of meshes that skins and morph targets deform.

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
