#include <algorithm>
#include <cmath>

#include <draco/compression/expert_encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "tests/traces/scene/gltf_seeds.h"
#include "traces/scene/bounds.h"

// Tests that compressed geometry equals uncompressed geometry, within the encoder's quantisation.

namespace test {
namespace {

using traces::Scene;

/// Returns the corners of all triangles in world space, in an order that does not depend on the encoder.
std::vector<std::array<float, 3>> corners(const Scene& scene) {
  std::vector<std::array<float, 3>> out;
  const traces::Mesh& mesh = scene.meshes.at(0);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) {
      const glm::vec3& p = mesh.positions[vertex];
      const auto snap = [](float v) { return std::round(v * 64) / 64; };  // the patch's coordinates are multiples of it
      out.push_back({snap(p.x), snap(p.y), std::round(p.z * 32) / 32});
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

void expect_same(const Scene& scene, float error) {
  const Scene plain = load(plain_patch());
  EXPECT_EQ(corners(scene), corners(plain));
  const traces::Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const float x = mesh.positions[i].x;
    EXPECT_NEAR(mesh.positions[i].z, x * x / 2, error);
    EXPECT_LT(glm::length(mesh.normals[i] - glm::normalize(glm::vec3(-x, 0, 1))), 0.02F);
  }
}

TEST(GltfDraco, BothMethodsGiveThePatch) {
  expect_same(load(draco_patch(true)), 1e-3F);
  expect_same(load(draco_patch(false)), 1e-3F);
}

TEST(GltfDraco, TextAndBinaryFilesAndTextureCoordinates) {
  TinyGltf file = draco_patch(true);
  file.json["images"] = nlohmann::json::array();
  const TempFolder folder;
  const Scene scene = traces::load_gltf(folder.write("a.glb", file.glb()));
  expect_same(scene, 1e-3F);
}

/// Returns a file with the tiny triangle as Draco data with joints as floats. `joints`, `weights`: their accessors.
TinyGltf draco_skin(int joint_type, const std::vector<float>& joints) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const auto add = [&](draco::GeometryAttribute::Type type, std::int8_t components, const std::vector<float>& values) {
    const int id = builder.AddAttribute(type, components, draco::DT_FLOAT32);
    const auto* corner = values.data();
    builder.SetAttributeValuesForFace(id, draco::FaceIndex(0), corner, corner + components, corner + 2 * components);
  };
  add(draco::GeometryAttribute::POSITION, 3, {0, 0, 0, 1, 0, 0, 0, 1, 0});
  add(draco::GeometryAttribute::GENERIC, 4, joints);
  add(draco::GeometryAttribute::GENERIC, 4, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::EncoderBuffer out;
  EXPECT_TRUE(draco::ExpertEncoder(*mesh).EncodeToBuffer(&out).ok());
  TinyGltf file;
  const int view = file.add_view({out.data(), out.size()});
  file.json["accessors"] = {{{"componentType", kFloat}, {"type", "VEC3"}, {"count", 3}},
                            {{"componentType", kUShort}, {"type", "SCALAR"}, {"count", 3}},
                            {{"componentType", joint_type}, {"type", "VEC4"}, {"count", 3}},
                            {{"componentType", kFloat}, {"type", "VEC4"}, {"count", 3}}};
  file.primitive()["attributes"] = {{"POSITION", 0}, {"JOINTS_0", 2}, {"WEIGHTS_0", 3}};
  file.primitive()["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}};
  file.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  file.json["nodes"] = {{{"mesh", 0}, {"skin", 0}}};
  file.json["skins"] = {{{"joints", nlohmann::json::array()}}};
  for (int joint = 1; joint <= 256; ++joint) {
    file.json["nodes"].push_back({{"translation", {0, 0, joint - 1}}});
    file.json["skins"][0]["joints"].push_back(joint);
    file.json["scenes"][0]["nodes"].push_back(joint);
  }
  return file;
}

TEST(GltfDraco, ValuesGetTheComponentTypeOfTheirAccessor) {
  for (const int type : {kUByte, kUShort}) {
    const Scene scene = load(draco_skin(type, {2, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0}));
    std::vector<float> depths;
    for (const glm::vec3& p : scene.meshes.at(0).positions) depths.push_back(p.z);
    std::ranges::sort(depths);
    EXPECT_EQ(depths, (std::vector<float>{0, 2, 255})) << "joint n moves its vertex to z = n";
  }
  EXPECT_SAYS(refusal(draco_skin(kUByte, std::vector<float>(12, 256)).text()),
              "the Draco attribute JOINTS_0: value 0 does not fit component type 5121");
  EXPECT_SAYS(refusal(draco_skin(kUByte, std::vector<float>(12, -1)).text()), "does not fit component type 5121");
}

TEST(GltfDraco, DamageIsRefused) {
  TinyGltf missing = draco_patch(true), none = draco_patch(true), old = draco_patch(true), cut = draco_patch(true);
  missing.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 9;
  EXPECT_SAYS(refusal(missing.text()), "the Draco attribute NORMAL is missing");
  none.binary[0] = 'X';
  EXPECT_SAYS(refusal(none.text()), "no Draco data");
  old.binary[6] = 1;
  EXPECT_SAYS(refusal(old.text()), "bitstream version 2.2");
  cut.json["bufferViews"][0]["byteLength"] = 40;
  EXPECT_SAYS(refusal(cut.text()), "damaged Draco data");
}

TEST(GltfDraco, AbsurdCountsAreRefusedBeforeMemoryIsTaken) {
  TinyGltf file = draco_patch(false);
  // After the header of 11 bytes come the numbers of faces and points, with 7 bits per byte.
  file.binary.replace(11, 5, "\xff\xff\xff\xff\x04");
  EXPECT_SAYS(refusal(file.text()), "of Draco data would take");
}

TEST(GltfMeshopt, FiltersAndFallbackBuffersGiveThePatch) {
  expect_same(load(meshopt_patch()), 1e-3F);
  const TempFolder folder;
  expect_same(traces::load_gltf(folder.write("a.glb", meshopt_patch().glb())), 1e-3F);
}

TEST(GltfMeshopt, TheNewNameOfTheExtensionIsAsGood) {
  TinyGltf file = meshopt_patch();
  for (auto& view : file.json["bufferViews"]) {
    view["extensions"]["KHR_meshopt_compression"] = view["extensions"]["EXT_meshopt_compression"];
    view["extensions"].erase("EXT_meshopt_compression");
  }
  expect_same(load(file), 1e-3F);
}

TEST(GltfMeshopt, IndexSequencesAndQuaternions) {
  TinyGltf file;
  const std::vector<std::uint32_t> order = {0, 1, 2};
  std::string indices(meshopt_encodeIndexSequenceBound(3, 3), '\0');
  indices.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(indices.data()), indices.size(),
                                             order.data(), order.size()));
  const float half = std::sqrt(0.5F);
  const std::vector<float> turns = {0, 0, half, half, 0, 0, 0, 1};
  std::vector<std::int16_t> packed(8);
  meshopt_encodeFilterQuat(packed.data(), 2, 8, 16, turns.data());
  std::string quaternions(meshopt_encodeVertexBufferBound(2, 8), '\0');
  quaternions.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(quaternions.data()),
                                                quaternions.size(), packed.data(), 2, 8));
  const auto compress = [&](int view, std::size_t count, std::size_t stride, const char* mode, const char* filter) {
    nlohmann::json& v = file.json["bufferViews"][static_cast<std::size_t>(view)];
    v["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},     {"byteOffset", v["byteOffset"]}, {"byteLength", v["byteLength"]},
        {"count", count},  {"byteStride", stride},          {"mode", mode},
        {"filter", filter}};
    v["byteLength"] = count * stride;
  };
  const int index_accessor = file.add_bytes(indices, kUShort, "SCALAR", 3, false);
  compress(file.json["accessors"].back()["bufferView"], 3, 2, "INDICES", "NONE");
  file.primitive()["indices"] = index_accessor;
  const int turn_accessor = file.add_bytes(quaternions, kShort, "VEC4", 2, true);
  compress(file.json["accessors"].back()["bufferView"], 2, 8, "ATTRIBUTES", "QUATERNION");
  file.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"ROTATION", turn_accessor}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.instances.size(), 2U);
  EXPECT_NEAR(scene.instances[0].to_world[0].y, 1, 1e-3F) << "a quarter turn about z";
  EXPECT_NEAR(scene.instances[1].to_world[0].x, 1, 1e-3F);
}

TEST(GltfMeshopt, DamageIsRefused) {
  const auto changed = [](const char* key, const nlohmann::json& value) {
    TinyGltf file = meshopt_patch();
    file.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    return refusal(file.text());
  };
  EXPECT_SAYS(changed("mode", "VERTICES"), "the mode is unknown");
  EXPECT_SAYS(changed("filter", "COLOR"), "the filter is unknown");
  EXPECT_SAYS(changed("byteStride", 10), "the stride is not");
  EXPECT_SAYS(changed("byteStride", -4), "byteStride is -4; allowed: a whole number of 0 or more");
  EXPECT_SAYS(changed("count", 1'000'000'000), "more than is left of the limit");
  EXPECT_SAYS(changed("count", 4000), "damaged");
  EXPECT_SAYS(changed("byteLength", 1'000'000), "leaves its buffer");
  EXPECT_SAYS(changed("byteLength", 7), "damaged");
  EXPECT_SAYS(changed("buffer", 9), "buffers[9]");
}

}  // namespace
}  // namespace test
