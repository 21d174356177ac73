#include "traces/scenes/builtin.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/bounds.h"
#include "traces/scene/info.h"
#include "traces/scenes/library.h"
#include "traces/scenes/teapot.h"

namespace test {
namespace {

using traces::Scene;

class Builtin : public testing::TestWithParam<std::string> {};

TEST_P(Builtin, IsWholeAndFinite) {
  const Scene scene = traces::build_scene(GetParam());
  EXPECT_EQ(scene.name, GetParam());
  EXPECT_EQ(scene.sha256.size(), 64U);
  EXPECT_EQ(scene.sha256, traces::build_scene(GetParam()).sha256);
  ASSERT_FALSE(scene.cameras.empty());
  EXPECT_EQ(scene.lights.size(), 1U);
  for (const traces::Instance& instance : scene.instances) ASSERT_LT(instance.mesh, scene.meshes.size());
  for (const traces::Mesh& mesh : scene.meshes) {
    ASSERT_LT(mesh.material, scene.materials.size());
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
    for (const glm::vec3& n : mesh.normals) ASSERT_NEAR(glm::length(n), 1, 1e-5);
    for (const auto& triangle : mesh.triangles) {
      glm::vec3 p[3];
      for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_LT(triangle[k], mesh.positions.size());
        p[k] = mesh.positions[triangle[k]];
      }
      const glm::vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
      ASSERT_GT(glm::length(normal), 0);
      ASSERT_GT(glm::dot(glm::normalize(normal), mesh.normals[triangle[0]]), 0.3F)
          << mesh.name << ": winding and normal";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Builtin, testing::Values("cornell", "teapot"),
                         [](const auto& test) { return test.param; });

TEST(BuiltinScenes, HaveTheSameBitsByEveryCompiler) {
  const std::pair<const char*, const char*> hashes[] = {
      {"atrium", "2988c027c52e1d8c"},     {"bathroom", "b2c5ecb01bbff1fe"},   {"car", "874f40d0250f92ca"},
      {"chess", "c89d7c2d940d8a14"},      {"conference", "5337138ec69dfc97"}, {"cornell", "9471b407625b0633"},
      {"crowd", "3e0cf2c95963af05"},      {"forest", "fb04767b88265ab4"},     {"hairball", "8164ca0742d38f96"},
      {"laboratory", "0a3a730c02e4576e"}, {"teapot", "ba05198197211764"},     {"village", "01dd20d234e8adb1"}};
  for (const auto& [name, hash] : hashes) EXPECT_EQ(traces::build_scene(name).sha256.substr(0, 16), hash) << name;
}

TEST(BuiltinScenes, AreTheSizeTheyClaim) {
  EXPECT_EQ(traces::scene_info(traces::build_scene("cornell")).triangles, 10'338U);
  EXPECT_EQ(traces::scene_info(traces::build_scene("teapot")).triangles, 14'792U);
}

TEST(BuiltinScenes, CornellBoxIsTwoByOne) {
  const traces::Bounds bounds = traces::world_bounds(traces::build_scene("cornell"));
  EXPECT_EQ(bounds.lower, glm::vec3(-2, -1, -1));
  EXPECT_EQ(bounds.upper, glm::vec3(2, 1, 1));
}

TEST(BuiltinScenes, TheTeapotShinesAndItsFloorIsTextured) {
  const Scene scene = traces::build_scene("teapot");
  EXPECT_GT(scene.materials.at(0).mirror, 0);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.materials.at(1).base_texture.texture, 0U);
  EXPECT_EQ(scene.textures[0].texels.size(), std::size_t{scene.textures[0].width} * scene.textures[0].height);
}

TEST(Teapot, HasNewellsProportions) {
  const std::vector<traces::BezierPatch> patches = traces::teapot_patches();
  ASSERT_EQ(patches.size(), 32U);
  traces::Bounds bounds;
  for (const auto& patch : patches) {
    for (int i = 0; i <= 8; ++i) {
      for (int j = 0; j <= 8; ++j) {
        bounds.add(traces::evaluate_patch(patch, static_cast<float>(i) / 8, static_cast<float>(j) / 8).position);
      }
    }
  }
  EXPECT_NEAR(bounds.lower.x, -3, 0.05);
  EXPECT_NEAR(bounds.upper.x, 3.43, 0.05);
  EXPECT_NEAR(bounds.lower.y, 0, 1e-6);
  EXPECT_NEAR(bounds.upper.y, 3.15, 1e-6);
  EXPECT_NEAR(bounds.upper.z, 2, 1e-6);
}

TEST(OpenScene, TakesBuiltInNames) { EXPECT_EQ(traces::open_scene("teapot").name, "teapot"); }

TEST(OpenScene, SuggestsTheNearestName) {
  try {
    traces::open_scene("cornel");
    FAIL();
  } catch (const sim::InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("did you mean 'cornell'?"), std::string::npos) << what;
    EXPECT_NE(what.find("teapot"), std::string::npos) << what;
  }
}

TEST(OpenScene, LooksForFilesInTheFoldersOfThePath) {
  const TempFolder folder;
  folder.write("mine.glb", TinyGltf().glb());
  setenv("RAYWATT_PATH", ("/nowhere:" + folder.path().string()).c_str(), 1);
  EXPECT_EQ(traces::open_scene("mine").name, "mine");
  EXPECT_EQ(traces::open_scene("teapot").name, "teapot");
  EXPECT_THROW(traces::open_scene("yours"), sim::InputError);
  unsetenv("RAYWATT_PATH");
}

TEST(OpenScene, SlashesAndExtensionsMakeAPath) {
  for (const char* path : {"./cornell", "cornell.glb", "nowhere/cornell"}) {
    EXPECT_THROW(traces::open_scene(path), sim::InputError) << path;
  }
}

}  // namespace
}  // namespace test
