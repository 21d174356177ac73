#include <cmath>

#include <gtest/gtest.h>

#include "tiny_gltf_file.h"
#include "traces/scene/scene.h"

namespace test {
namespace {

using traces::pose_scene;
using traces::Scene;

/// Adds a channel to the first animation of a file.
void animate(TinyGltf& file, int node, const std::string& path, int times, int values,
             const std::string& interpolation = "LINEAR") {
  auto& animation = file.json["animations"][0];
  const std::size_t sampler = animation["samplers"].size();
  animation["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", interpolation}});
  animation["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

int add_floats(TinyGltf& file, const std::vector<float>& values, const std::string& type, std::size_t count) {
  return file.add(values, kFloat, type, count);
}

/// Returns a file whose triangle slides from x = 0 to x = 2 in one second.
TinyGltf sliding() {
  TinyGltf file;
  animate(file, 0, "translation", add_floats(file, {0, 1}, "SCALAR", 2),
          add_floats(file, {0, 0, 0, 2, 0, 0}, "VEC3", 2));
  return file;
}

/// Returns a file whose triangle is attached to node 1 as joint; node 0 shows it.
TinyGltf skinned() {
  TinyGltf file;
  file.json["nodes"].push_back({{"translation", {0, 0, 5}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  const std::vector<float> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::vector<float> two = identity;
  two.insert(two.end(), identity.begin(), identity.end());
  file.json["skins"] = {{{"joints", {1}}, {"inverseBindMatrices", add_floats(file, two, "MAT4", 2)}}};
  file.node()["skin"] = 0;
  file.node()["translation"] = {100, 0, 0};
  const std::vector<std::uint8_t> joints(12, 0);
  std::vector<float> weights(12, 0);
  for (std::size_t i = 0; i < 12; i += 4) weights[i] = 2;  // need not sum to 1
  file.primitive()["attributes"]["JOINTS_0"] = file.add(joints, kUByte, "VEC4", 3);
  file.primitive()["attributes"]["WEIGHTS_0"] = add_floats(file, weights, "VEC4", 3);
  return file;
}

TinyGltf morphing() {
  TinyGltf file;
  const int up = add_floats(file, {0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  file.primitive()["targets"] = {{{"POSITION", up}}};
  return file;
}

float x_of(const Scene& scene) { return scene.instances[0].to_world[3][0]; }

TEST(GltfAnimations, AreReadAsTracks) {
  Scene scene = load(sliding());
  ASSERT_EQ(scene.tracks.size(), 1U);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(traces::animation_seconds(scene), 1);
  EXPECT_TRUE(pose_scene(scene, 0.5).geometry);
  EXPECT_EQ(x_of(scene), 1);
}

TEST(GltfAnimations, AFileIsLoadedAsItIsAtTimeZero) {
  TinyGltf file = sliding();
  file.node()["translation"] = {7, 0, 0};  // differs from the animation
  EXPECT_EQ(x_of(load(file)), 0);
}

TEST(GltfAnimations, AStillFileIsTheSameToTheBitWhateverTheTime) {
  TinyGltf file;
  file.node()["rotation"] = {0.1, 0.2, 0.3, 0.4};
  file.node()["children"] = {1};
  file.json["nodes"].push_back(
      {{"matrix", {0.1, 0.7, 0, 0, 0.3, 1.1, 0, 0, 0, 0, 0.9, 0, 3.3, 4.4, 5.5, 1}}, {"mesh", 0}, {"camera", 0}});
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
  file.material()["emissiveFactor"] = {1, 1, 1};
  const Scene loaded = load(file);
  ASSERT_NE(loaded.lights[0].node, traces::kNone) << "a light stands in for the emitter";
  Scene scene = loaded;
  for (const double seconds : {0.0, 12.5}) {
    const traces::Moved moved = pose_scene(scene, seconds);
    EXPECT_FALSE(moved.geometry || moved.view || moved.lights);
    for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(scene.instances[i].to_world, loaded.instances[i].to_world);
    EXPECT_EQ(scene.cameras[0].to_world, loaded.cameras[0].to_world);
    EXPECT_EQ(scene.lights[0].position, loaded.lights[0].position);
    EXPECT_EQ(scene.lights[0].direction, loaded.lights[0].direction);
  }
}

TEST(GltfAnimations, NormalisedIntegersAreRotationsToo) {
  TinyGltf file;
  const std::vector<std::int16_t> shorts{0, 0, 0, 32767, 0, 0, 23170, 23170};
  animate(file, 0, "rotation", add_floats(file, {0, 1}, "SCALAR", 2), file.add(shorts, kShort, "VEC4", 2, true));
  Scene scene = load(file);
  pose_scene(scene, 1);
  EXPECT_NEAR(scene.instances[0].to_world[0][1], 1, 1e-6);
}

TEST(GltfAnimations, TheFirstOfTwoForOneNodeAndPathCounts) {
  TinyGltf file = sliding();
  file.json["animations"].push_back(file.json["animations"][0]);
  file.json["animations"][1]["name"] = "again";
  const Scene scene = load(file);
  EXPECT_EQ(scene.tracks.size(), 1U);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "animations[1] again");
}

TEST(GltfAnimations, PointersAreLeftOutWithAWarning) {
  TinyGltf file = sliding();
  file.json["animations"][0]["channels"][0]["target"]["path"] = "pointer";
  const Scene scene = load(file);
  EXPECT_TRUE(scene.tracks.empty());
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "KHR_animation_pointer");
}

TEST(GltfAnimations, ANodeScaledToZeroMayGrow) {
  TinyGltf file;
  animate(file, 0, "scale", add_floats(file, {0, 1}, "SCALAR", 2), add_floats(file, {0, 0, 0, 1, 1, 1}, "VEC3", 2));
  file.node()["scale"] = {0, 0, 0};
  Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 1U);
  pose_scene(scene, 1);
  EXPECT_EQ(scene.instances[0].to_world, glm::mat4(1));
}

TEST(GltfSkins, PutTheMeshWhereItsJointsAre) {
  const Scene scene = load(skinned());
  EXPECT_EQ(scene.warnings, std::vector<std::string>{});
  EXPECT_EQ(scene.instances[0].to_world, glm::mat4(1));
  ASSERT_EQ(scene.meshes[0].positions.size(), 3U);
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 5));
}

TEST(GltfSkins, InverseBindMatricesAreApplied) {
  TinyGltf file = skinned();
  const std::vector<float> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1};
  file.json["skins"][0]["inverseBindMatrices"] = add_floats(file, matrix, "MAT4", 1);
  EXPECT_EQ(load(file).meshes[0].positions[1], glm::vec3(1, 0, 0));
}

TEST(GltfSkins, NeedNoInverseBindMatrices) {
  TinyGltf file = skinned();
  file.json["skins"][0].erase("inverseBindMatrices");
  EXPECT_EQ(load(file).meshes[0].positions[1], glm::vec3(1, 0, 5));
}

TEST(GltfSkins, FurtherSetsOfJointsAreFoldedIntoTheFourLargest) {
  TinyGltf file = skinned();
  file.json["nodes"].push_back({{"translation", {0, 0, 9}}});
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  file.json["skins"][0]["joints"] = {1, 2};
  const std::vector<std::uint16_t> joints(12, 1);
  std::vector<float> weights(12, 0);
  for (std::size_t i = 0; i < 12; i += 4) weights[i] = 6;
  file.primitive()["attributes"]["JOINTS_1"] = file.add(joints, kUShort, "VEC4", 3);
  file.primitive()["attributes"]["WEIGHTS_1"] = add_floats(file, weights, "VEC4", 3);
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes[0].positions[1], glm::vec3(1, 0, 8));  // a quarter of 5, three quarters of 9
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "four largest weights");
}

TEST(GltfSkins, AMeshHasACopyForEachNodeThatBendsIt) {
  TinyGltf file = skinned();
  file.json["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
  file.json["nodes"].push_back({{"mesh", 0}});
  file.json["nodes"].push_back({{"mesh", 0}});
  file.json["scenes"][0]["nodes"] = {0, 1, 2, 3, 4};
  const Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 4U);
  EXPECT_NE(scene.instances[0].mesh, scene.instances[1].mesh);
  EXPECT_EQ(scene.instances[2].mesh, scene.instances[3].mesh) << "rigid ones share theirs";
  EXPECT_EQ(scene.meshes.size(), 3U);
}

TEST(GltfMorphTargets, WeightsOfTheNodeGoBeforeThoseOfTheMesh) {
  TinyGltf file = morphing();
  EXPECT_EQ(load(file).meshes[0].positions[0].z, 0);
  file.json["meshes"][0]["weights"] = {0.5};
  EXPECT_EQ(load(file).meshes[0].positions[0].z, 0.5F);
  file.node()["weights"] = {0.25};
  EXPECT_EQ(load(file).meshes[0].positions[0].z, 0.25F);
}

TEST(GltfMorphTargets, AreAnimated) {
  TinyGltf file = morphing();
  const std::vector<std::uint8_t> weights{0, 255};
  animate(file, 0, "weights", add_floats(file, {0, 2}, "SCALAR", 2), file.add(weights, kUByte, "SCALAR", 2, true));
  Scene scene = load(file);
  EXPECT_TRUE(pose_scene(scene, 1).geometry);
  EXPECT_FLOAT_EQ(scene.meshes[0].positions[2].z, 0.5F);
}

TEST(GltfMorphTargets, MayBeSparseWithoutAnythingDense) {
  TinyGltf file = morphing();
  const std::vector<std::uint16_t> indices{1};
  const std::vector<float> values{0, 0, 3};
  const int index_view = file.add_view(std::string(reinterpret_cast<const char*>(indices.data()), 2) + "  ");
  const int value_view = file.add_view(std::string(reinterpret_cast<const char*>(values.data()), 12));
  const std::size_t accessor = file.json["accessors"].size();
  file.json["accessors"].push_back({{"componentType", kFloat},
                                    {"type", "VEC3"},
                                    {"count", 3},
                                    {"sparse",
                                     {{"count", 1},
                                      {"indices", {{"bufferView", index_view}, {"componentType", kUShort}}},
                                      {"values", {{"bufferView", value_view}}}}}});
  file.primitive()["targets"][0]["POSITION"] = accessor;
  file.node()["weights"] = {1};
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes[0].positions[0].z, 0);
  EXPECT_EQ(scene.meshes[0].positions[1].z, 3);
}

// Animations that are refused with one line.

TEST(BrokenAnimations, AreRefused) {
  const auto said = [](auto change) {
    TinyGltf file = sliding();
    change(file, file.json["animations"][0]["samplers"][0]);
    return refusal(file.text());
  };
  EXPECT_SAYS(said([](TinyGltf& f, auto& s) { s["input"] = add_floats(f, {1, 0}, "SCALAR", 2); }), "must grow");
  EXPECT_SAYS(said([](TinyGltf& f, auto& s) { s["input"] = add_floats(f, {0, NAN}, "SCALAR", 2); }), "not a finite");
  EXPECT_SAYS(said([](TinyGltf& f, auto& s) {
                s["input"] = add_floats(f, {0, 1, 2}, "SCALAR", 3);
              }),
              "6 numbers for 3 keys of 3");
  EXPECT_SAYS(said([](TinyGltf&, auto& s) { s["interpolation"] = "CUBICSPLINE"; }), "6 numbers for 2 keys of 9");
  EXPECT_SAYS(said([](TinyGltf&, auto& s) { s["interpolation"] = "BEZIER"; }), "LINEAR, STEP, CUBICSPLINE");
  EXPECT_SAYS(said([](TinyGltf&, auto& s) { s["output"] = s["input"]; }), "wrong type");
  EXPECT_SAYS(said([](TinyGltf&, auto& s) { s["output"] = 99; }), "accessors[99]");
  EXPECT_SAYS(said([](TinyGltf& f, auto&) { f.json["animations"][0]["channels"][0]["sampler"] = 4; }), "samplers[4]");
  EXPECT_SAYS(said([](TinyGltf& f, auto&) { f.json["animations"][0]["channels"][0]["target"]["node"] = 4; }),
              "nodes[4]");
  EXPECT_SAYS(said([](TinyGltf& f, auto& s) {
                s["output"] = add_floats(f, {1e30F, 0, 0, 0, 0, 0}, "VEC3", 2);
              }),
              "further than");
}

TEST(BrokenSkins, AreRefused) {
  const auto said = [](auto change) {
    TinyGltf file = skinned();
    change(file);
    return refusal(file.text());
  };
  EXPECT_SAYS(said([](TinyGltf& f) { f.json["skins"][0]["joints"] = {17}; }), "nodes[17]");
  EXPECT_SAYS(said([](TinyGltf& f) { f.json["scenes"][0]["nodes"] = {0}; }), "is not in the scene");
  EXPECT_SAYS(said([](TinyGltf& f) { f.node()["skin"] = 3; }), "skins[3]");
  EXPECT_SAYS(said([](TinyGltf& f) {
                f.primitive()["attributes"]["JOINTS_0"] = f.add(std::vector<std::uint8_t>(12, 1), kUByte, "VEC4", 3);
              }),
              "joint 1 of a skin that has 1");
  EXPECT_SAYS(said([](TinyGltf& f) {
                f.primitive()["attributes"]["WEIGHTS_0"] = add_floats(f, std::vector<float>(8, 1), "VEC4", 2);
              }),
              "2 joint weights for 3 vertices");
  EXPECT_SAYS(said([](TinyGltf& f) {
                f.primitive()["attributes"]["JOINTS_0"] = add_floats(f, std::vector<float>(12, 0), "VEC4", 3);
              }),
              "allowed are 5121, 5123");
  EXPECT_SAYS(said([](TinyGltf& f) {
                f.json["skins"][0]["joints"] = {1, 0};
                f.json["skins"][0]["inverseBindMatrices"] = add_floats(f, std::vector<float>(16, 0), "MAT4", 1);
              }),
              "1 inverse bind matrices for 2 joints");
}

TEST(BrokenMorphTargets, AreRefused) {
  TinyGltf file = morphing();
  file.primitive()["targets"][0]["POSITION"] = add_floats(file, {1, 2, 3}, "VEC3", 1);
  EXPECT_SAYS(refusal(file.text()), "1 displacements for 3 vertices");
  file = morphing();
  animate(file, 0, "weights", add_floats(file, {0}, "SCALAR", 1), add_floats(file, {0, 1}, "SCALAR", 2));
  EXPECT_SAYS(refusal(file.text()), "2 numbers for 1 keys of 1");
}

}  // namespace
}  // namespace test
