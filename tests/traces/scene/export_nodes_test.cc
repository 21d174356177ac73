#include <algorithm>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/traces/scene/exported.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

using nlohmann::json;
using traces::Scene;

TEST(ExportOfNodes, AShearComesBackFromTwoNodes) {
  Scene scene = traces::build_scene("cornell");
  glm::mat4& to_world = scene.instances[0].to_world;
  to_world = {{1, 0, 0, 0}, {0.75F, 2, 0, 0}, {0, -0.5F, 3, 0}, {5, 6, 7, 1}};
  scene.instances[1].to_world = {{1000, 0, 0, 0}, {0, -1e-3F, 0, 0}, {500, 0, 1, 0}, {0, 0, 0, 1}};
  const Scene back = round_trip_text(scene);
  for (std::size_t i = 0; i < 2; ++i) {
    for (int column = 0; column < 4; ++column) {
      const glm::vec3 wanted(scene.instances[i].to_world[column]);
      expect_near(glm::vec3(back.instances[i].to_world[column]), wanted, 2e-6F * (i == 0 ? 3.0F : 1000.0F));
    }
  }
}

TEST(ExportOfNodes, AFlatMatrixComesBack) {
  Scene scene = traces::build_scene("cornell");
  // Singular matrices of rank 2, 1 and 0. No two columns of a matrix are orthogonal.
  const glm::mat4 flat[] = {{{1, 2, 3, 0}, {2, 1, -1, 0}, {3, 3, 2, 0}, {5, 6, 7, 1}},
                            {{1, 2, 3, 0}, {-2, -4, -6, 0}, {0.5F, 1, 1.5F, 0}, {0, 0, 1, 1}},
                            {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {1, 0, 0, 1}}};
  for (std::size_t i = 0; i < 3; ++i) scene.instances[i].to_world = flat[i];
  const Scene back = round_trip_text(scene);
  ASSERT_EQ(back.instances.size(), scene.instances.size());
  for (std::size_t i = 0; i < 3; ++i) {
    for (int column = 0; column < 4; ++column) {
      expect_near(glm::vec3(back.instances[i].to_world[column]), glm::vec3(flat[i][column]), 1e-5F);
    }
  }
}

TEST(ExportOfNodes, AnEmptyNodeIsAnEmptyObject) {
  TinyGltf file;
  file.json["nodes"].push_back(json::object());
  file.json["scenes"][0]["nodes"] = {0, 1};
  const json document = exported(load(file));
  EXPECT_EQ(document["nodes"][1], json::object());
  EXPECT_EQ(document.dump().find("null"), std::string::npos);
}

/// Returns a file with the tiny triangle on a skin of the nodes 1 and 2, which are roots.
TinyGltf skinned_by_two_roots() {
  TinyGltf file;
  file.primitive()["attributes"]["JOINTS_0"] =
      file.add<std::uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}, kUByte, "VEC4", 3);
  file.primitive()["attributes"]["WEIGHTS_0"] =
      file.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4", 3);
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 1}}, {{"translation", {0, 0, 1}}}, {{"translation", {0, 0, 2}}}};
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  file.json["skins"] = {{{"joints", {0}}}, {{"joints", {1, 2, 1}}}};
  return file;
}

TEST(ExportOfSkins, ThoseThatNothingShowsAreLeftOut) {
  const json document = exported(load(skinned_by_two_roots()));
  EXPECT_EQ(document["skins"].size(), 1U);
  EXPECT_EQ(node_of(document, "part")["skin"], 0);
}

TEST(ExportOfSkins, JointsDifferAndHaveACommonRoot) {
  const Scene scene = load(skinned_by_two_roots()), back = round_trip_text(scene);
  const json document = exported(scene);
  const auto joints = document["skins"][0]["joints"].get<std::vector<int>>();
  EXPECT_EQ(std::set<int>(joints.begin(), joints.end()).size(), 3U);
  std::size_t parents = 0;
  for (const json& node : document["nodes"]) {
    const auto children = node.value("children", std::vector<int>{});
    if (std::ranges::find(children, joints[0]) != children.end()) {
      EXPECT_NE(std::ranges::find(children, joints[1]), children.end());
      ++parents;
    }
  }
  EXPECT_EQ(parents, 1U);
  EXPECT_EQ(back.meshes.at(0).positions, scene.meshes.at(0).positions);
  EXPECT_EQ(back.meshes[0].positions.at(1).z, 2);
}

TEST(ExportOfNodes, FocusIsNotedInTheExtras) {
  const json document = exported(feature_scene());
  EXPECT_EQ(node_of(document, "board")["extras"]["focus"], true);
  EXPECT_FALSE(node_of(document, "arm").contains("extras"));
}

TEST(ExportOfNodes, ASkinnedMeshHangsBelowTheSceneAndNamesEachJointOnce) {
  const std::string glb = traces::export_glb(feature_scene());
  const json document = document_of(glb), cloth = node_of(document, "cloth");
  EXPECT_EQ(cloth["skin"], 0);
  EXPECT_EQ(document["skins"][0]["joints"].size(), 2U);
  EXPECT_EQ(document["nodes"][document["skins"][0]["joints"][0].get<std::size_t>()]["name"], "hip");
  const json attributes = document["meshes"][cloth["mesh"].get<std::size_t>()]["primitives"][0]["attributes"];
  const auto bytes_of = [&](const char* name) {
    const json view =
        document["bufferViews"]
                [document["accessors"][attributes[name].get<std::size_t>()]["bufferView"].get<std::size_t>()];
    std::uint32_t json_size = 0;
    std::memcpy(&json_size, glb.data() + 12, sizeof json_size);
    return glb.substr(20 + json_size + 8 + view.value("byteOffset", std::size_t{0}), view["byteLength"]);
  };
  std::array<std::array<std::uint16_t, 4>, 4> joints{};
  std::array<glm::vec4, 4> weights{};
  std::memcpy(joints.data(), bytes_of("JOINTS_0").data(), sizeof joints);
  std::memcpy(weights.data(), bytes_of("WEIGHTS_0").data(), sizeof weights);
  EXPECT_EQ(joints[1], (std::array<std::uint16_t, 4>{0, 0, 0, 0})) << "joints without weight are none";
  EXPECT_EQ(joints[2], (std::array<std::uint16_t, 4>{0, 0, 1, 0}));
  EXPECT_EQ(weights[2], glm::vec4(0.5F, 0, 0.5F, 0)) << "a joint named twice has the sum of its weights";
}

TEST(ExportOfNodes, MorphTargetsKeepTheirWeights) {
  const json document = exported(feature_scene()), flag = node_of(document, "flag");
  EXPECT_EQ(flag["weights"], json({0.25, 0.0}));
  const json primitive = document["meshes"][flag["mesh"].get<std::size_t>()]["primitives"][0];
  ASSERT_EQ(primitive["targets"].size(), 2U);
  EXPECT_TRUE(primitive["targets"][0].contains("NORMAL"));
  EXPECT_FALSE(primitive["targets"][1].contains("NORMAL"));
}

TEST(ExportOfTracks, TheFirstForANodeAndPathCounts) {
  const json document = exported(feature_scene()), animation = document["animations"].at(0);
  EXPECT_EQ(animation["channels"].size(), 5U);
  EXPECT_EQ(animation["samplers"][0]["interpolation"], "LINEAR");
  EXPECT_EQ(animation["samplers"][1]["interpolation"], "STEP");
  EXPECT_EQ(animation["samplers"][2]["interpolation"], "CUBICSPLINE");
  EXPECT_EQ(animation["channels"][3]["target"]["path"], "weights");
  EXPECT_EQ(animation["samplers"][0]["input"], animation["samplers"][1]["input"]) << "equal times are stored once";
  const json times = document["accessors"][animation["samplers"][0]["input"].get<std::size_t>()];
  EXPECT_EQ(times["min"], json({0.0}));
  EXPECT_EQ(times["max"], json({2.0}));
}

TEST(ExportOfTracks, MoveNodesWithoutMatrix) {
  const json document = exported(feature_scene());
  for (const json& channel : document["animations"][0]["channels"]) {
    EXPECT_FALSE(document["nodes"][channel["target"]["node"].get<std::size_t>()].contains("matrix"));
  }
}

/// Returns the world positions of the vertices of all instances of meshes called `mesh`.
std::vector<glm::vec3> shown(const Scene& scene, const std::string& mesh) {
  std::vector<glm::vec3> points;
  for (const traces::Instance& instance : scene.instances) {
    if (scene.meshes[instance.mesh].name != mesh) continue;
    for (const glm::vec3& p : scene.meshes[instance.mesh].positions) {
      points.emplace_back(instance.to_world * glm::vec4(p, 1));
    }
  }
  return points;
}

TEST(ExportOfTracks, EverythingMovesAsBefore) {
  Scene scene = feature_scene(), back = round_trip_text(scene);
  EXPECT_EQ(traces::animation_seconds(back), 2);
  std::vector<glm::vec3> before;
  for (const double seconds : {0.0, 0.25, 0.5, 0.75, 1.0, 3.0}) {
    traces::pose_scene(scene, seconds);
    traces::pose_scene(back, seconds);
    for (const char* mesh : {"board", "pane", "sign", "cloth", "flag"}) {
      const std::vector<glm::vec3> wanted = shown(scene, mesh), got = shown(back, mesh);
      ASSERT_EQ(got.size(), wanted.size()) << mesh;
      for (std::size_t i = 0; i < wanted.size(); ++i) expect_near(got[i], wanted[i], 1e-5F);
    }
    const auto moving = [](const Scene& s) { return s.cameras.at(1).to_world[3]; };
    expect_near(glm::vec3(moving(back)), glm::vec3(moving(scene)), 1e-5F);
    EXPECT_NE(shown(back, "cloth"), before) << "at " << seconds;
    before = shown(back, "cloth");
  }
}

TEST(ExportOfCameras, TheFirstStaysTheFirst) {
  Scene scene = feature_scene();
  EXPECT_EQ(round_trip_text(scene).cameras.at(0).name, "still");
  std::swap(scene.cameras[0], scene.cameras[1]);
  EXPECT_EQ(round_trip_text(scene).cameras.at(0).name, "moving");
}

TEST(ExportOfLights, KindPlaceConeAndStrengthComeBack) {
  const Scene scene = feature_scene(), back = round_trip_text(scene);
  ASSERT_EQ(back.lights.size(), 3U);
  for (const traces::Light& light : scene.lights) {
    const auto same = std::ranges::find(back.lights, light.kind, &traces::Light::kind);
    ASSERT_NE(same, back.lights.end());
    expect_near(same->intensity, light.intensity, 1e-6F);
    if (light.kind != traces::Light::Kind::kPoint) expect_near(same->direction, light.direction, 1e-6F);
    if (light.kind != traces::Light::Kind::kDirectional) expect_near(same->position, light.position, 1e-6F);
    if (light.kind != traces::Light::Kind::kSpot) continue;
    EXPECT_NEAR(same->cos_inner, light.cos_inner, 1e-6F);
    EXPECT_NEAR(same->cos_outer, light.cos_outer, 1e-6F);
  }
  EXPECT_EQ(back.background, scene.background);
  EXPECT_EQ(back.ambient, scene.ambient);
}

TEST(ExportOfLights, AreInTheUnitsOfGltf) {
  const json lights = exported(feature_scene())["extensions"]["KHR_lights_punctual"]["lights"];
  EXPECT_NEAR(lights[0]["intensity"].get<double>(), 0.7 * std::numbers::pi, 1e-6) << "lux: pi makes white shine with 1";
  EXPECT_EQ(lights[0]["color"][0], 1);
}

TEST(FinalLight, OfAFileMustBeThreeNumbers) {
  TinyGltf file;
  for (const json& bad : {json({1, 2}), json("white"), json({1, 2, "x"}), json({1, 2, 1e300})}) {
    file.json["scenes"][0]["extras"]["raywatt"] = {{"background", bad}, {"ambient", {0, 0, 0}}};
    EXPECT_SAYS(refusal(file.text()), "extras.raywatt.background");
  }
}

TEST(FinalLight, WithoutBothColoursIsNone) {
  TinyGltf file;
  const float usual = load(file).ambient.x;
  for (const json& other : {json(1), json::object(), json({{"ambient", {0, 0, 0}}})}) {
    file.json["scenes"][0]["extras"]["raywatt"] = other;
    EXPECT_EQ(load(file).ambient.x, usual);
  }
}

TEST(ExportOfTracks, BeginAtZeroAndGrow) {
  Scene scene = feature_scene();
  scene.tracks[0].times = {-1, 0.5F, 2};
  scene.tracks[1].times = {-2, 0, 0};
  scene.tracks[4].times = {0.75F, 0.75F};
  scene.tracks[2].times = {-0.5F, 1};
  scene.tracks[2].values = {0, 0, 0, 1, 1, 1, 1, 2, 0.5F, 0.25F, 0.5F, 0.75F, 2, 1, 3, 0, 0, 0};
  scene.tracks[3].times = {-3, -2, -1};
  Scene back = round_trip_text(scene);
  ASSERT_EQ(back.tracks.size(), 5U);
  for (const traces::Track& track : back.tracks) {
    EXPECT_GE(track.times.at(0), 0);
    for (std::size_t i = 1; i < track.times.size(); ++i) EXPECT_GT(track.times[i], track.times[i - 1]);
  }
  for (const double seconds : {0.0, 0.25, 0.75, 1.5, 3.0}) {
    traces::pose_scene(scene, seconds);
    traces::pose_scene(back, seconds);
    for (const char* mesh : {"board", "pane", "sign", "cloth", "flag"}) {
      const std::vector<glm::vec3> wanted = shown(scene, mesh), got = shown(back, mesh);
      ASSERT_EQ(got.size(), wanted.size()) << mesh;
      for (std::size_t i = 0; i < wanted.size(); ++i) expect_near(got[i], wanted[i], 1e-5F);
    }
  }
}

}  // namespace
}  // namespace test
