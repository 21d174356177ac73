#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"

// Tests of a file's node hierarchy, which animations move.

namespace test {
namespace {

using traces::kNone;
using traces::Scene;

/// Returns a file with a root that has two children; the second one shows the triangle.
TinyGltf family() {
  TinyGltf file;
  file.json["nodes"] = {{{"name", "child"}, {"mesh", 0}, {"translation", {0, 2, 0}}, {"scale", {2, 2, 2}}},
                        {{"name", "stranger"}, {"mesh", 0}},
                        {{"name", "root"}, {"children", {3, 0}}, {"translation", {1, 0, 0}}},
                        {{"name", "other child"}}};
  file.json["scenes"] = {{{"nodes", {1}}}, {{"nodes", {2}}}};
  file.json["scene"] = 1;
  return file;
}

TEST(GltfNodes, TheNodesOfTheDefaultSceneAreKeptParentsFirst) {
  const Scene scene = load(family());
  ASSERT_EQ(scene.nodes.size(), 3U);
  EXPECT_EQ(scene.nodes[0].name, "root");
  EXPECT_EQ(scene.nodes[0].parent, kNone);
  EXPECT_EQ(scene.nodes[1].name, "other child");
  EXPECT_EQ(scene.nodes[2].name, "child");
  EXPECT_EQ(scene.nodes[2].parent, 0U);
  EXPECT_EQ(scene.nodes[2].rest.translation, glm::vec3(0, 2, 0));
  EXPECT_EQ(scene.nodes[2].rest.scale, glm::vec3(2));
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_EQ(scene.instances[0].node, 2U);
  EXPECT_EQ(scene.instances[0].to_world[3], glm::vec4(1, 2, 0, 1));
}

TEST(GltfNodes, WithoutADefaultTheFirstSceneIsShown) {
  TinyGltf file = family();
  file.json.erase("scene");
  EXPECT_EQ(load(file).nodes.at(0).name, "stranger");
}

TEST(GltfNodes, MatricesStayMatrices) {
  TinyGltf file;
  file.node()["matrix"] = {2, 0, 0, 0, 0, 1, 0, 0, 0.5, 0, 1, 0, 5, 6, 7, 1};
  const Scene scene = load(file);
  EXPECT_EQ(scene.nodes.at(0).matrix[2], glm::vec4(0.5F, 0, 1, 0));
  EXPECT_EQ(scene.nodes[0].rest.translation, glm::vec3(0));
  EXPECT_EQ(scene.instances.at(0).to_world, scene.nodes[0].matrix);
}

TEST(GltfNodes, CamerasAndLightsStoreTheirNode) {
  TinyGltf file;
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"range", 12.5}}};
  file.json["nodes"].push_back(
      {{"camera", 0}, {"translation", {0, 0, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const Scene scene = load(file);
  EXPECT_EQ(scene.cameras.at(0).node, 1U);
  EXPECT_EQ(scene.lights.at(0).node, 1U);
  EXPECT_EQ(scene.lights[0].in_node, glm::mat4(1));
  EXPECT_EQ(scene.lights[0].range, 12.5F);
}

TEST(GltfNodes, TheLightOfALampMovesWithTheLamp) {
  TinyGltf file;
  file.material()["emissiveFactor"] = {1, 1, 1};
  file.node()["translation"] = {5, 0, 0};
  file.node()["scale"] = {2, 2, 2};
  const Scene scene = load(file);
  const traces::Light& light = scene.lights.at(0);
  EXPECT_EQ(light.node, 0U);
  const glm::mat4 placed = scene.instances.at(0).to_world * light.in_node;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(placed[3][k], light.position[k], 1e-5F);
    EXPECT_NEAR(-glm::normalize(glm::vec3(placed[2]))[k], light.direction[k], 1e-5F);
  }
}

TEST(GltfNodes, TheLightOfAFlatLampIsAtTheLamp) {
  // Rotated, flattened, rotated: the determinant is 0 except for rounding.
  TinyGltf file;
  file.material()["emissiveFactor"] = {1, 1, 1};
  file.json["nodes"] = {{{"rotation", {0.1, 0.2, 0.3, 0.9}}, {"scale", {1, 1, 0}}, {"children", {1}}},
                        {{"rotation", {0.3, 0.1, 0.2, 0.9}}, {"mesh", 0}}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 1U);
  EXPECT_LT(glm::length(scene.lights.at(0).position), 2) << "the triangle is within 1 of the origin";
}

TEST(GltfNodes, FocusIsMarkedOnNodesOrMeshes) {
  TinyGltf file;
  EXPECT_FALSE(load(file).instances.at(0).focus);
  file.node()["extras"] = {{"focus", true}};
  EXPECT_TRUE(load(file).instances.at(0).focus);
  file.node()["extras"] = {{"focus", "yes"}};
  EXPECT_FALSE(load(file).instances.at(0).focus);
  file.json["meshes"][0]["extras"] = {{"focus", true}};
  EXPECT_TRUE(load(file).instances.at(0).focus);
}

TEST(GltfNodes, InstancesOnTheGpuAreNodesOfTheirOwn) {
  TinyGltf file;
  const int translations = file.add<float>({1, 0, 0, 0, 3, 0}, kFloat, "VEC3", 2);
  file.node()["translation"] = {0, 0, 9};
  file.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", translations}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_EQ(scene.instances[0].to_world[3], glm::vec4(1, 0, 9, 1));
  EXPECT_EQ(scene.instances[1].to_world[3], glm::vec4(0, 3, 9, 1));
  ASSERT_EQ(scene.nodes.size(), 3U);
  EXPECT_EQ(scene.nodes[2].parent, 0U);
  EXPECT_EQ(scene.instances[1].node, 2U);
  const int scales = file.add<float>({1, 1, 1}, kFloat, "VEC3", 1);
  file.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = scales;
  EXPECT_SAYS(refusal(file.text()), "1 values of SCALE for 2 instances");
}

TEST(GltfNodes, CamerasOfOneNameGetANumber) {
  TinyGltf file;
  file.json["cameras"] = {{{"type", "perspective"}, {"name", "eye"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}},
                          {{"type", "orthographic"},
                           {"name", "flat"},
                           {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}}}}};
  file.json["nodes"] = {{{"mesh", 0}, {"camera", 0}}, {{"camera", 0}}, {{"camera", 1}}, {{"camera", 0}}};
  file.json["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const Scene scene = load(file);
  ASSERT_EQ(scene.cameras.size(), 3U);
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_EQ(scene.cameras[1].name, "eye 2");
  EXPECT_EQ(scene.cameras[2].name, "eye 3");
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "'flat': only perspective");
}

}  // namespace
}  // namespace test
