#include "traces/scene/export.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/traces/scene/exported.h"
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

}  // namespace
}  // namespace test
