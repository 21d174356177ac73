#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "traces/scene/animation.h"
#include "traces/scene/bounds.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/plants.h"
#include "traces/scenes/modelling/shapes.h"

namespace test {
namespace {

using traces::Scene;

struct Case {
  const char* name;
  std::uint32_t triangles;
  float reach;  ///< upper bound of the distance from the origin
  std::size_t textures, lights;
};
constexpr Case kCases[] = {
    {"village", 600'000, 1100, 20, 1}, {"forest", 174'000, 60, 14, 2}, {"hairball", 2'880'000, 12, 2, 3}};

/// Returns a built-in scene, which is built once for all tests.
const Scene& scene_of(std::string_view name) {
  static std::vector<Scene> made;
  const auto found = std::ranges::find(made, name, &Scene::name);
  return found != made.end() ? *found : made.emplace_back(traces::build_scene(name));
}

class NatureScene : public testing::TestWithParam<Case> {};

TEST_P(NatureScene, HasTheTrianglesOfItsClass) {
  const auto count = static_cast<double>(traces::count_triangles(scene_of(GetParam().name)));
  EXPECT_NEAR(count, GetParam().triangles, 0.05 * GetParam().triangles);
}

TEST_P(NatureScene, HasAboutTheRequestedNumberOfTriangles) {
  for (const double factor : {0.25, 2.0}) {
    if (GetParam().triangles * factor > 2e6) continue;  // takes long
    const auto wanted = static_cast<std::uint32_t>(factor * GetParam().triangles);
    const auto count = static_cast<double>(traces::count_triangles(traces::build_scene(GetParam().name, {wanted})));
    EXPECT_NEAR(count, wanted, 0.25 * wanted);
  }
}

TEST_P(NatureScene, IsTheSameEachTime) {
  EXPECT_EQ(traces::build_scene(GetParam().name).sha256, scene_of(GetParam().name).sha256);
}

TEST_P(NatureScene, HasTexturesLightsAndTwoCamerasAndMoves) {
  const Scene& scene = scene_of(GetParam().name);
  EXPECT_GE(scene.textures.size(), GetParam().textures);
  EXPECT_EQ(scene.lights.size(), GetParam().lights);
  ASSERT_GE(scene.cameras.size(), 2U);
  EXPECT_EQ(scene.cameras[0].node, traces::kNone);
  EXPECT_EQ(scene.cameras.back().name, "path");
  EXPECT_NE(scene.cameras.back().node, traces::kNone);
  EXPECT_GT(traces::animation_seconds(scene), 10);
}

TEST_P(NatureScene, StaysWithinItsBounds) {
  const traces::Bounds bounds = traces::world_bounds(scene_of(GetParam().name));
  EXPECT_LT(std::max(glm::length(bounds.lower), glm::length(bounds.upper)), 1.5F * GetParam().reach);
}

TEST_P(NatureScene, HasWholeMeshes) {
  const Scene& scene = scene_of(GetParam().name);
  for (const traces::Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    if (!mesh.uvs.empty()) {
      ASSERT_EQ(mesh.uvs.size(), mesh.positions.size());
    }
    if (scene.materials[mesh.material].base_texture.is_used()) {
      ASSERT_FALSE(mesh.uvs.empty()) << mesh.name;
    }
    std::size_t crooked = 0;
    for (const auto& t : mesh.triangles) {
      ASSERT_LT(*std::ranges::max_element(t), mesh.positions.size()) << mesh.name;
      const glm::vec3 a = mesh.positions[t[0]];
      const glm::vec3 normal = glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
      crooked += glm::dot(normal, mesh.normals[t[0]]) > 0 ? 0 : 1;
    }
    EXPECT_LE(crooked, mesh.triangles.size() / 50) << mesh.name << ": winding and normal";
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      ASSERT_TRUE(std::isfinite(glm::dot(mesh.positions[i], mesh.positions[i]))) << mesh.name;
      ASSERT_NEAR(glm::length(mesh.normals[i]), 1, 1e-4) << mesh.name;
    }
  }
}

/// True if the ray from `from` along `way` hits the triangle.
bool meets(const glm::vec3& from, const glm::vec3& way, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 u = b - a, v = c - a, p = glm::cross(way, v), s = from - a, q = glm::cross(s, u);
  const float d = glm::dot(u, p), x = glm::dot(s, p) / d, y = glm::dot(way, q) / d;
  return x >= 0 && y >= 0 && x + y <= 1 && glm::dot(v, q) / d > 0;
}

TEST_P(NatureScene, FillsMostOfItsFirstPicture) {
  const Scene& scene = scene_of(GetParam().name);
  const traces::Camera& camera = scene.cameras[0];
  const glm::vec3 eye(camera.to_world[3]);
  const float slope = std::tan(camera.vertical_fov / 2);
  constexpr int kColumns = 8, kRows = 4;
  int filled = 0;
  for (int k = 0; k < kColumns * kRows; ++k) {
    const float x = (static_cast<float>(k % kColumns) + 0.5F) / kColumns * 2 - 1;
    const float y = (static_cast<float>(k / kColumns) + 0.5F) / kRows * 2 - 1;
    const glm::vec3 way = glm::vec3(camera.to_world * glm::vec4(2 * slope * x, slope * y, -1, 0));
    filled += std::ranges::any_of(scene.instances,
                                  [&](const traces::Instance& instance) {
                                    const traces::Mesh& mesh = scene.meshes[instance.mesh];
                                    const auto at = [&](std::uint32_t i) {
                                      return glm::vec3(instance.to_world * glm::vec4(mesh.positions[i], 1));
                                    };
                                    return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
                                      return meets(eye, way, at(t[0]), at(t[1]), at(t[2]));
                                    });
                                  })
                  ? 1
                  : 0;
  }
  EXPECT_GT(filled, kColumns * kRows * 6 / 10);
}

INSTANTIATE_TEST_SUITE_P(Scenes, NatureScene, testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Forest, PointsOutWhatIsOfInterest) {
  const Scene& scene = scene_of("forest");
  std::vector<std::string> focus;
  for (const traces::Instance& i : scene.instances) {
    if (i.focus) focus.push_back(scene.meshes[i.mesh].name);
  }
  EXPECT_EQ(std::ranges::count(focus, "mushroom cap"), 3);
  EXPECT_EQ(std::ranges::count(focus, "deer"), 1);
  EXPECT_EQ(std::ranges::count(focus, "lantern"), 1);
  EXPECT_LT(focus.size(), scene.instances.size() / 10);
}

TEST(Village, IsFlownThroughInSevenHundredFrames) {
  EXPECT_NEAR(traces::animation_seconds(scene_of("village")) * 30, 699, 0.5);
}

TEST(Village, ItsCameraKeepsAwayFromThings) {
  Scene scene = scene_of("village");
  const auto path = std::ranges::find(scene.cameras, "path", &traces::Camera::name);
  ASSERT_NE(path, scene.cameras.end());
  for (double seconds = 0; seconds <= traces::animation_seconds(scene); seconds += 0.2) {
    traces::pose_scene(scene, seconds);
    const glm::vec3 eye(path->to_world[3]);
    for (const traces::Instance& instance : scene.instances) {
      if (glm::distance(eye, glm::vec3(instance.to_world[3])) > 30) continue;
      const traces::Mesh& mesh = scene.meshes[instance.mesh];
      for (const glm::vec3& p : mesh.positions) {
        ASSERT_GT(glm::distance(eye, glm::vec3(instance.to_world * glm::vec4(p, 1))), 0.8F)
            << mesh.name << " at " << seconds << " s";
      }
    }
  }
}

TEST(Village, OnlyTheSailsTurn) {
  Scene scene = scene_of("village");
  const std::vector<traces::Instance> before = scene.instances;
  traces::pose_scene(scene, 1);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool moved = scene.instances[i].to_world != before[i].to_world;
    EXPECT_EQ(moved, scene.meshes[before[i].mesh].name.starts_with("sails")) << scene.meshes[before[i].mesh].name;
  }
}

TEST(Plants, ATreeStandsOnItsFootAndReachesItsHeight) {
  const traces::Tree tree = traces::make_tree("tree", {.height = 10, .reach = 3});
  traces::Bounds bounds;
  for (const glm::vec3& p : tree.wood.positions) bounds.add(p);
  EXPECT_LT(bounds.lower.y, 0);
  EXPECT_NEAR(bounds.upper.y, 10, 2);
  EXPECT_LT(bounds.upper.x, 6);
  EXPECT_GT(tree.twigs.size(), 60U);
}

TEST(Plants, LeavesAreOfTwoTriangles) {
  const std::vector<traces::Twig> twigs = traces::dome_twigs({1, 1, 1}, 8, 3);
  EXPECT_EQ(traces::make_leaves("leaves", twigs, 50, {}, {0, 0, 0}, 4).triangles.size(), 100U);
}

TEST(Plants, GrassHasTwoTrianglesASegmentButTheTip) {
  EXPECT_EQ(traces::make_grass("grass", 10, 3, 1, 0.5F, 0.02F, 1).triangles.size(), 10U * 5);
}

}  // namespace
}  // namespace test
