#include "traces/scene/export.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "sim/error.h"
#include "sim/hash.h"
#include "tests/real_scenes.h"
#include "tests/traces/scene/exported.h"
#include "tests/traces/scene/feature_scene.h"
#include "tests/traces/scene/gltf_mutants.h"
#include "tests/traces/scene/gltf_seeds.h"
#include "tests/traces/scene/random_gltf.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

using nlohmann::json;
using traces::Material;
using traces::Scene;

class ExportOfBuiltin : public testing::TestWithParam<std::string> {};

TEST_P(ExportOfBuiltin, GivesTheSameSceneBack) {
  const Scene scene = traces::build_scene(GetParam()), back = round_trip_text(scene);
  ASSERT_EQ(back.instances.size(), scene.instances.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const traces::Mesh &mesh = scene.meshes[scene.instances[i].mesh], &same = back.meshes[back.instances[i].mesh];
    EXPECT_EQ(back.instances[i].to_world, scene.instances[i].to_world);
    EXPECT_EQ(same.positions, mesh.positions) << mesh.name;
    if (scene.materials[mesh.material].base_texture.is_used()) {
      EXPECT_EQ(same.uvs, mesh.uvs) << mesh.name;
    }
    EXPECT_EQ(same.triangles, mesh.triangles) << mesh.name;
    for (std::size_t v = 0; v < mesh.normals.size(); ++v) expect_near(same.normals[v], mesh.normals[v], 1e-6F);
  }
  ASSERT_EQ(back.materials.size(), scene.materials.size());
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material &m = scene.materials[i], &same = back.materials[i];
    EXPECT_EQ(same.name, m.name);
    EXPECT_EQ(same.base_colour, m.base_colour) << m.name;
    EXPECT_EQ(same.base_texture.texture, m.base_texture.texture) << m.name;
    EXPECT_NEAR(same.mirror, m.mirror, 1e-5F) << m.name;
    if (m.mirror > 0) expect_near(same.mirror_tint, m.mirror_tint, 1e-5F);
    EXPECT_EQ(same.transmission, m.transmission) << m.name;
    EXPECT_EQ(same.double_sided, m.double_sided) << m.name;
    EXPECT_EQ(same.emission, m.emission) << m.name;
  }
  ASSERT_EQ(back.textures.size(), scene.textures.size());
  for (std::size_t i = 0; i < scene.textures.size(); ++i) EXPECT_EQ(back.textures[i].texels, scene.textures[i].texels);
  ASSERT_EQ(back.lights.size(), scene.lights.size()) << "an emitter's light is not made again";
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    EXPECT_EQ(back.lights[i].kind, scene.lights[i].kind);
    expect_near(back.lights[i].intensity / scene.lights[i].intensity, glm::vec3(1), 1e-6F);
  }
  ASSERT_EQ(back.cameras.size(), scene.cameras.size());
  EXPECT_EQ(back.cameras[0].name, scene.cameras[0].name);
  EXPECT_EQ(back.cameras[0].vertical_fov, scene.cameras[0].vertical_fov);
  EXPECT_EQ(back.background, scene.background);
  EXPECT_EQ(back.ambient, scene.ambient);
  EXPECT_TRUE(back.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(Scenes, ExportOfBuiltin, testing::Values("cornell", "teapot"),
                         [](const auto& test) { return test.param; });

TEST(Export, OfEqualScenesIsEqualBytes) {
  EXPECT_EQ(traces::export_glb(feature_scene()), traces::export_glb(feature_scene()));
}

TEST(Export, OfAnExportIsTheSameScene) {
  const Scene once = round_trip_text(traces::build_scene("cornell")), twice = round_trip_text(once);
  EXPECT_EQ(document_of(traces::export_glb(twice))["materials"], document_of(traces::export_glb(once))["materials"]);
  EXPECT_EQ(twice.lights.size(), once.lights.size());
}

TEST(Export, InstancesOfOneMeshShareIt) {
  const json document = exported(feature_scene());
  EXPECT_EQ(document["meshes"].size(), feature_scene().meshes.size());
  int boards = 0;
  for (const json& node : document["nodes"]) {
    if (node.contains("mesh") && document["meshes"][node["mesh"].get<std::size_t>()]["name"] == "board") ++boards;
  }
  EXPECT_EQ(boards, 2);
}

TEST(Export, IndicesTakeSixteenBitsUpTo65535Vertices) {
  Scene scene = traces::build_scene("cornell");
  scene.instances.resize(1);
  for (const auto& [vertices, type] : {std::pair{0xffffU, 5123}, {0x10000U, 5125}}) {
    scene.meshes[0].positions.resize(vertices, glm::vec3(0));
    scene.meshes[0].normals.resize(vertices, glm::vec3(0, 1, 0));
    scene.meshes[0].uvs.resize(vertices, glm::vec2(0));
    const json document = exported(scene);
    const std::size_t indices = document["meshes"][0]["primitives"][0]["indices"];
    EXPECT_EQ(document["accessors"][indices]["componentType"], type);
  }
}

TEST(Export, PositionsHaveTheirBounds) {
  const json document = exported(feature_scene());
  for (const json& mesh : document["meshes"]) {
    const std::size_t positions = mesh["primitives"][0]["attributes"]["POSITION"];
    EXPECT_EQ(document["accessors"][positions]["min"], json({-1.0, -1.0, 0.0}));
    EXPECT_EQ(document["accessors"][positions]["max"], json({1.0, 1.0, 0.0}));
  }
}

TEST(Export, AMeshHasTheAttributesThatItsMaterialUses) {
  const json document = exported(feature_scene());
  const json board = document["meshes"][node_of(document, "board")["mesh"].get<std::size_t>()]["primitives"][0];
  for (const char* name : {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "TEXCOORD_1", "COLOR_0"}) {
    EXPECT_TRUE(board["attributes"].contains(name)) << name;
  }
}

TEST(Export, ATexturedMaterialOnAMeshWithoutCoordinatesLooksUpTheOrigin) {
  Scene scene = feature_scene();
  scene.meshes[0].uvs.clear();
  scene.meshes[0].second_uvs.clear();
  const json document = exported(scene);
  const json board = document["meshes"][node_of(document, "board")["mesh"].get<std::size_t>()]["primitives"][0];
  EXPECT_TRUE(board["attributes"].contains("TEXCOORD_1"));
}

TEST(Export, EveryAttributeComesBack) {
  const Scene scene = feature_scene(), back = round_trip_text(scene);
  const auto mesh = [](const Scene& s) { return *std::ranges::find(s.meshes, "board", &traces::Mesh::name); };
  EXPECT_EQ(mesh(back).uvs, mesh(scene).uvs);
  EXPECT_EQ(mesh(back).second_uvs, mesh(scene).second_uvs);
  EXPECT_EQ(mesh(back).tangents, mesh(scene).tangents);
  EXPECT_EQ(mesh(back).colours, mesh(scene).colours);
}

/// Returns a surface without textures after export and reload.
Material reloaded(const Material& m) {
  Scene scene = traces::build_scene("cornell");
  for (Material& each : scene.materials) each = m;
  return round_trip_text(scene).materials.at(0);
}

TEST(ExportOfSurfaces, MirrorsComeBackAsTheyWere) {
  const glm::vec3 white(1), red(0.8F, 0.2F, 0.1F), half = 0.5F * (white + red);
  struct Case {
    float mirror;
    glm::vec3 tint, base;
  };
  for (const Case& c : {Case{0, white, red},
                        {0.08F, white, red},
                        {0.3F, white, red},
                        {0.9F, white, glm::vec3(0.9F)},
                        {0.6F, red, red},
                        {0.4F, half, red},
                        {0.5F, white, white},
                        {0.25F, white, white},
                        {0.2F, white, glm::vec3(0)},
                        {1, white, glm::vec3(0)}}) {
    Material m;
    m.mirror = c.mirror;
    m.mirror_tint = c.tint;
    m.base_colour = c.base;
    const Material back = reloaded(m);
    EXPECT_NEAR(back.mirror, m.mirror, 1e-5F);
    if (m.mirror > 0) expect_near(back.mirror_tint, m.mirror_tint, 1e-5F);
    if (m.mirror < 1) expect_near(back.base_colour, m.base_colour, 1e-6F);
  }
}

TEST(ExportOfSurfaces, APureMirrorIsASmoothMetal) {
  Scene scene = traces::build_scene("cornell");
  scene.materials[0].mirror = 1;
  scene.materials[0].mirror_tint = {0.5F, 0.25F, 1};
  const json surface = exported(scene)["materials"][0]["pbrMetallicRoughness"];
  EXPECT_EQ(surface.value("metallicFactor", 1.0), 1);
  EXPECT_EQ(surface["roughnessFactor"], 0);
  EXPECT_EQ(surface["baseColorFactor"], json({0.5, 0.25, 1.0, 1.0}));
}

TEST(ExportOfSurfaces, ATexturedMirrorsTintIsTheMeanOfItsTexture) {
  Scene scene = traces::build_scene("teapot");
  Material& floor = scene.materials.at(1);
  ASSERT_TRUE(floor.base_texture.is_used());
  floor.mirror = 0.3F;
  floor.mirror_tint = glm::vec3(1);
  const Material back = round_trip_text(scene).materials.at(1);
  EXPECT_NEAR(back.mirror, 0.3F, 1e-5F);
  expect_near(back.mirror_tint, glm::vec3(1), 1e-4F);
}

TEST(ExportOfSurfaces, GlassKeepsItsIndexAndAColdReflection) {
  Material glass;
  glass.transmission = 0.75F;
  glass.ior = 1.33F;
  glass.mirror = 0.05F;
  const Material back = reloaded(glass);
  EXPECT_FLOAT_EQ(back.transmission, 0.75F);
  EXPECT_FLOAT_EQ(back.ior, 1.33F);
  EXPECT_NEAR(back.mirror, 0.05F, 1e-5F);
}

TEST(ExportOfSurfaces, AThinSheetHasAnIndexForItsMirrorAndNoThickness) {
  Scene scene = feature_scene();
  Material& pane = scene.materials[1];
  pane.ior = 1;
  pane.absorption = glm::vec3(0);
  EXPECT_FALSE(exported(scene)["materials"][1]["extensions"].contains("KHR_materials_volume"));
  pane.mirror = 0.18F;
  const json extensions = exported(scene)["materials"][1]["extensions"];
  EXPECT_EQ(extensions["KHR_materials_volume"]["thicknessFactor"], 0);
  EXPECT_NEAR(extensions["KHR_materials_ior"]["ior"].get<double>(), 1.3 / 0.7, 1e-6) << "twice 0.3 squared";
}

TEST(ExportOfSurfaces, AbsorptionIsAColourAfterADistance) {
  const json volume = exported(feature_scene())["materials"][1]["extensions"]["KHR_materials_volume"];
  const glm::dvec3 absorption(0.5, 0.1, 0.7);
  for (int i = 0; i < 3; ++i) {
    const double colour = volume["attenuationColor"][static_cast<std::size_t>(i)];
    EXPECT_NEAR(-std::log(colour) / volume["attenuationDistance"].get<double>(), absorption[i], 1e-6);
  }
}

TEST(ExportOfSurfaces, TexturesKeepTheirRoles) {
  const json document = exported(feature_scene());
  const json all = document["materials"][0];
  EXPECT_EQ(all["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
  EXPECT_EQ(all["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"], 2);
  EXPECT_EQ(all["pbrMetallicRoughness"]["metallicFactor"], 0.75);
  EXPECT_EQ(all["normalTexture"], json({{"index", 3}, {"scale", 0.5}}));
  EXPECT_EQ(all["occlusionTexture"], json({{"index", 4}, {"texCoord", 1}, {"strength", 0.75}}));
  EXPECT_EQ(all["emissiveTexture"]["index"], 5);
  EXPECT_EQ(all["alphaMode"], "MASK");
  EXPECT_EQ(all["alphaCutoff"], 0.25);
  EXPECT_NEAR(all["extensions"]["KHR_materials_clearcoat"]["clearcoatFactor"].get<double>(), 0.5, 1e-6);
  const double ior = all["extensions"]["KHR_materials_ior"]["ior"];
  EXPECT_NEAR(2 * std::pow((ior - 1) / (ior + 1), 2), 0.1, 1e-6);
  EXPECT_EQ(document["materials"][3]["alphaMode"], "BLEND");
  EXPECT_EQ(document["materials"][3]["pbrMetallicRoughness"]["baseColorFactor"][3], 0.5);
  EXPECT_TRUE(document["materials"][4]["extensions"].contains("KHR_materials_unlit"));
}

TEST(ExportOfSurfaces, EmissionAboveOneHasAStrength) {
  Scene scene = feature_scene();
  scene.materials[1].emission = {4, 2, 1};
  const json glowing = exported(scene)["materials"][1];
  EXPECT_EQ(glowing["emissiveFactor"], json({1.0, 0.5, 0.25}));
  EXPECT_EQ(glowing["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 4);
}

TEST(ExportOfTextures, EqualTexelsShareAPicture) {
  const json document = exported(feature_scene());
  EXPECT_EQ(document["images"].size(), 5U);
  EXPECT_EQ(document["textures"].size(), 6U);
  EXPECT_EQ(document["textures"][0]["source"], document["textures"][1]["source"]);
  EXPECT_NE(document["textures"][0]["sampler"], document["textures"][1]["sampler"]);
}

TEST(ExportOfTextures, ColourAndAlphaKeepEveryBit) {
  Scene scene = traces::build_scene("teapot");
  scene.textures[0].texels[0] = 0x00123456;  // the colour of fully transparent texels is kept, too
  scene.textures[0].texels[1] = 0x7fabcdef;
  EXPECT_EQ(round_trip_text(scene).textures.at(0).texels, scene.textures[0].texels);
}

TEST(ExportOfSurfaces, EveryFieldComesBack) {
  const Scene scene = feature_scene(), back = round_trip_text(scene);
  ASSERT_EQ(back.materials.size(), scene.materials.size());
  const Material &all = scene.materials[0], &same = back.materials[0];
  for (const auto member : {&Material::base_texture, &Material::metal_rough_texture, &Material::normal_texture,
                            &Material::occlusion_texture, &Material::emission_texture}) {
    EXPECT_EQ(back.textures.at((same.*member).texture).texels, scene.textures.at((all.*member).texture).texels);
    EXPECT_EQ((same.*member).second_uv, (all.*member).second_uv);
  }
  for (const auto member : {&Material::metallic, &Material::roughness, &Material::dielectric, &Material::coat,
                            &Material::normal_scale, &Material::occlusion_strength, &Material::alpha_cutoff}) {
    EXPECT_NEAR(same.*member, all.*member, 1e-6F);
  }
  EXPECT_EQ(same.alpha, Material::Alpha::kMask);
  EXPECT_EQ(same.emission, all.emission);
  expect_near(back.materials[1].absorption, scene.materials[1].absorption, 1e-5F);
  EXPECT_EQ(back.materials[3].alpha, Material::Alpha::kBlend);
  EXPECT_EQ(back.materials[3].opacity, 0.5F);
  EXPECT_EQ(back.materials[4].emission, scene.materials[4].emission);
  EXPECT_FALSE(back.materials[4].casts_light);
  const traces::Texture& veil = back.textures.at(back.materials[3].base_texture.texture);
  EXPECT_EQ(veil.filter, traces::Texture::Filter::kNearest);
  EXPECT_EQ(veil.wrap_u, traces::Texture::Wrap::kMirror);
  EXPECT_EQ(veil.wrap_v, traces::Texture::Wrap::kClamp);
}

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

// Tests that the Khronos validator reports neither errors nor warnings about exported scenes. RAYWATT_EXPORTS sets the
// number of random files (default 16), and adds large built-in scenes and real scenes.

std::size_t files_wanted() {
  const char* wanted = std::getenv("RAYWATT_EXPORTS");
  return wanted == nullptr ? 16 : std::strtoull(wanted, nullptr, 10);
}

bool is_long() { return std::getenv("RAYWATT_EXPORTS") != nullptr; }

/// Exports scenes and validates many of them in one run of the validator.
class Exports {
 public:
  ~Exports() { std::cout << count_ << " exports validated\n"; }

  void add(const std::string& name, const traces::Scene& scene) {
    const std::string glb = traces::export_glb(scene);
    std::string file = std::to_string(count_++) + " " + name + ".glb";
    std::ranges::replace(file, '/', '-');
    list_ += folder_.write(file, glb).string() + "\n";
    bytes_ += glb.size();
    ++waiting_;
    if (waiting_ == 100 || bytes_ > kMostBytes) {
      EXPECT_EQ(complaints(), "");
    }
  }

  /// Runs the validator on the files since the last call and returns its output.
  std::string complaints() {
    if (waiting_ == 0) return {};
    if (std::system("command -v node >/dev/null") != 0) return "node is not installed; tools/test installs it";
    if (!std::filesystem::exists(GLTF_VALIDATOR_MODULES)) {
      return "the glTF validator is not installed in " GLTF_VALIDATOR_MODULES "; tools/test installs it";
    }
    const TempFolder folder;
    const std::filesystem::path list = folder.write("list", list_), said = folder.path() / "said";
    const std::string command =
        "node '" GLTF_VALIDATOR "' '" GLTF_VALIDATOR_MODULES "' <'" + list.string() + "' >'" + said.string() + "' 2>&1";
    const int status = std::system(command.c_str());
    const std::string text = read_bytes(said);
    std::istringstream files(std::exchange(list_, {}));
    for (std::string file; std::getline(files, file);) std::filesystem::remove(file);
    waiting_ = bytes_ = 0;
    return status != 0 && text.empty() ? "the validator failed" : text;
  }

 private:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 28;
  TempFolder folder_;
  std::string list_;
  std::size_t count_ = 0, waiting_ = 0, bytes_ = 0;
};

/// Reads a file, and exports it if it is valid.
void add_file(Exports& exports, const std::string& name, const std::string& bytes) {
  const TempFolder folder;
  traces::SceneLimits limits;
  limits.memory = {std::uint64_t{1} << 26};
  try {
    exports.add(name, traces::load_gltf(folder.write("a.gltf", bytes), limits));
  } catch (const sim::InputError&) {
  }
}

TEST(ExportValidity, TheValidatorFindsWhatIsWrong) {
  Exports exports;
  traces::Scene scene = feature_scene();
  scene.materials[0].name = "fine";
  scene.cameras[0].vertical_fov = -1;
  exports.add("a camera without an angle", scene);
  EXPECT_SAYS(exports.complaints(), "0 a camera without an angle.glb: error ");
}

TEST(ExportValidity, OfBuiltinScenes) {
  Exports exports;
  for (const traces::BuiltinInfo& info : traces::builtin_scenes()) {
    if (!is_long() && info.triangles > 60'000) continue;
    exports.add(info.name, traces::build_scene(info.name));
    for (const std::uint32_t triangles : {1000U, 20'000U}) {
      if (is_long()) exports.add(info.name, traces::build_scene(info.name, {.triangles = triangles}));
    }
  }
  exports.add("features", feature_scene());
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfRandomFiles) {
  Exports exports;
  for (std::size_t i = 0; i < files_wanted(); ++i) add_file(exports, "random", random_gltf(i).text());
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfChangedFiles) {
  Exports exports;
  const std::size_t mutants = is_long() ? 150 : 20;
  for (const Seed& seed : seeds()) {
    add_file(exports, seed.name, seed.file.text());
    for (std::size_t i = 0; i < mutants; ++i) {
      add_file(exports, seed.name, mutant_of(seed.file, sim::hash(i, seed.name.size())));
    }
  }
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfTheFuzzCorpus) {
  Exports exports;
  for (const char* target : {"glb", "gltf"}) {
    const std::filesystem::path corpus = std::filesystem::path(RAYWATT_SOURCE_DIR) / "tests/fuzz/corpus" / target;
    for (const auto& entry : std::filesystem::directory_iterator(corpus)) {
      add_file(exports, entry.path().filename().string(), read_bytes(entry.path()));
    }
  }
  EXPECT_EQ(exports.complaints(), "");
}

TEST(ExportValidity, OfRealScenes) {
  if (!is_long()) GTEST_SKIP() << "RAYWATT_EXPORTS is not set";
  if (!std::filesystem::exists(scenes_folder())) GTEST_SKIP() << "there are no scenes in " << scenes_folder();
  Exports exports;
  for (const auto& entry : std::filesystem::directory_iterator(scenes_folder())) {
    if (entry.path().extension() != ".glb") continue;
    exports.add(entry.path().stem().string(), traces::load_gltf(entry.path()));
  }
  EXPECT_EQ(exports.complaints(), "");
}

}  // namespace
}  // namespace test
