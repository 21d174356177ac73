#include "traces/scene/export.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/traces/scene/feature_scene.h"
#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

using nlohmann::json;
using traces::Material;
using traces::Scene;

json document_of(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, sizeof size);
  return json::parse(glb.substr(20, size));
}

json exported(const Scene& scene) { return document_of(traces::export_glb(scene)); }

Scene there_and_back(const Scene& scene) {
  const TempFolder folder;
  return traces::load_gltf(folder.write("scene.glb", traces::export_glb(scene)));
}

/// The node of that name.
json node_of(const json& document, const std::string& name) {
  for (const json& node : document["nodes"]) {
    if (node.value("name", "") == name) return node;
  }
  ADD_FAILURE() << "no node is called " << name;
  return {};
}

void expect_near(const glm::vec3& a, const glm::vec3& b, float most) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], most);
}

class ExportOfBuiltin : public testing::TestWithParam<std::string> {};

TEST_P(ExportOfBuiltin, GivesTheSameSceneBack) {
  const Scene scene = traces::build_scene(GetParam()), back = there_and_back(scene);
  ASSERT_EQ(back.instances.size(), scene.instances.size());
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const traces::Mesh &mesh = scene.meshes[scene.instances[i].mesh], &same = back.meshes[back.instances[i].mesh];
    EXPECT_EQ(back.instances[i].to_world, scene.instances[i].to_world);
    EXPECT_EQ(same.positions, mesh.positions) << mesh.name;
    if (scene.materials[mesh.material].base_texture.used()) {
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
  const Scene once = there_and_back(traces::build_scene("cornell")), twice = there_and_back(once);
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

/// A surface without textures and what the loader makes of its export.
Material reloaded(const Material& m) {
  Scene scene = traces::build_scene("cornell");
  for (Material& each : scene.materials) each = m;
  return there_and_back(scene).materials.at(0);
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
  ASSERT_TRUE(floor.base_texture.used());
  floor.mirror = 0.3F;
  floor.mirror_tint = glm::vec3(1);
  const Material back = there_and_back(scene).materials.at(1);
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

TEST(ExportOfSurfaces, TexturesStandInTheirPlaces) {
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
  scene.textures[0].texels[0] = 0x00123456;  // the colour of what is not there is kept, too
  scene.textures[0].texels[1] = 0x7fabcdef;
  EXPECT_EQ(there_and_back(scene).textures.at(0).texels, scene.textures[0].texels);
}

TEST(ExportOfNodes, AShearComesBackFromTwoNodes) {
  Scene scene = traces::build_scene("cornell");
  glm::mat4& to_world = scene.instances[0].to_world;
  to_world = {{1, 0, 0, 0}, {0.75F, 2, 0, 0}, {0, -0.5F, 3, 0}, {5, 6, 7, 1}};
  scene.instances[1].to_world = {{1000, 0, 0, 0}, {0, -1e-3F, 0, 0}, {500, 0, 1, 0}, {0, 0, 0, 1}};
  const Scene back = there_and_back(scene);
  for (std::size_t i = 0; i < 2; ++i) {
    for (int column = 0; column < 4; ++column) {
      const glm::vec3 wanted(scene.instances[i].to_world[column]);
      expect_near(glm::vec3(back.instances[i].to_world[column]), wanted, 2e-6F * (i == 0 ? 3.0F : 1000.0F));
    }
  }
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

/// World positions of the vertices of all instances of meshes of that name.
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
  Scene scene = feature_scene(), back = there_and_back(scene);
  EXPECT_EQ(traces::duration(back), 2);
  std::vector<glm::vec3> before;
  for (const double seconds : {0.0, 0.25, 0.5, 0.75, 1.0, 3.0}) {
    traces::pose(scene, seconds);
    traces::pose(back, seconds);
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

TEST(ExportOfSurfaces, EveryFieldComesBack) {
  const Scene scene = feature_scene(), back = there_and_back(scene);
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

TEST(Export, EveryAttributeComesBack) {
  const Scene scene = feature_scene(), back = there_and_back(scene);
  const auto mesh = [](const Scene& s) { return *std::ranges::find(s.meshes, "board", &traces::Mesh::name); };
  EXPECT_EQ(mesh(back).uvs, mesh(scene).uvs);
  EXPECT_EQ(mesh(back).second_uvs, mesh(scene).second_uvs);
  EXPECT_EQ(mesh(back).tangents, mesh(scene).tangents);
  EXPECT_EQ(mesh(back).colours, mesh(scene).colours);
}

TEST(ExportOfCameras, TheFirstStaysTheFirst) {
  Scene scene = feature_scene();
  EXPECT_EQ(there_and_back(scene).cameras.at(0).name, "still");
  std::swap(scene.cameras[0], scene.cameras[1]);
  EXPECT_EQ(there_and_back(scene).cameras.at(0).name, "moving");
}

TEST(ExportOfLights, KindPlaceConeAndStrengthComeBack) {
  const Scene scene = feature_scene(), back = there_and_back(scene);
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

}  // namespace
}  // namespace test
