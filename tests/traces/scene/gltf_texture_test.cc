#include <cmath>

#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/images.h"

// Tests of the textures of a material: how they are chosen, read, and placed on the mesh.

namespace test {
namespace {

using nlohmann::json;
using traces::Material;
using traces::Scene;

/// Returns a file whose triangle has texture coordinates, and whose texture 0 is a red and blue picture.
TinyGltf textured() {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 2, 1, std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255});
  TinyGltf file;
  file.json["images"] = {
      {{"bufferView", file.add_view(read_bytes(folder.path() / "a.png"))}, {"mimeType", "image/png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  return file;
}

json moved(double u) { return {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {u, 0}}}}}}}; }

TEST(GltfTextures, EveryKindIsReadAndTheSameImageServesAsColourAndAsNumbers) {
  TinyGltf file = textured();
  json& m = file.material();
  m["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}},
                               {"metallicRoughnessTexture", {{"index", 0}}},
                               {"metallicFactor", 0.5},
                               {"roughnessFactor", 0.75}};
  m["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
  m["occlusionTexture"] = {{"index", 0}, {"strength", 0.25}};
  m["emissiveTexture"] = {{"index", 0}};
  m["emissiveFactor"] = {1, 0.5, 0};
  const Scene scene = load(file);
  ASSERT_EQ(scene.textures.size(), 2U);
  EXPECT_TRUE(scene.textures[0].srgb);
  EXPECT_FALSE(scene.textures[1].srgb);
  EXPECT_EQ(scene.textures[0].texels, scene.textures[1].texels);
  const Material& read = scene.materials.at(0);
  EXPECT_EQ(read.base_texture.texture, 0U);
  EXPECT_EQ(read.metal_rough_texture.texture, 1U);
  EXPECT_EQ(read.normal_texture.texture, 1U);
  EXPECT_EQ(read.occlusion_texture.texture, 1U);
  EXPECT_EQ(read.emission_texture.texture, 0U);
  EXPECT_EQ(read.metallic, 0.5F);
  EXPECT_EQ(read.roughness, 0.75F);
  EXPECT_EQ(read.normal_scale, 0.5F);
  EXPECT_EQ(read.occlusion_strength, 0.25F);
  EXPECT_EQ(read.emission, glm::vec3(1, 0.5F, 0));
  EXPECT_FALSE(read.normal_texture.second_uv);
}

TEST(GltfTextures, SamplersSelectTheFilter) {
  TinyGltf file = textured();
  file.json["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9987}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  file.material()["emissiveTexture"] = {{"index", 1}};
  file.material()["emissiveFactor"] = {1, 1, 1};
  const Scene scene = load(file);
  ASSERT_EQ(scene.textures.size(), 2U);
  EXPECT_EQ(scene.textures[0].filter, traces::Texture::Filter::kNearest);
  EXPECT_EQ(scene.textures[1].filter, traces::Texture::Filter::kLinear);
}

TEST(GltfTextures, TwoPlacementsFillTwoSetsOfCoordinates) {
  TinyGltf file = textured();
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = moved(0.25);
  file.material()["emissiveTexture"] = moved(0.5);
  file.material()["emissiveFactor"] = {1, 1, 1};
  file.material()["normalTexture"] = moved(0.25);
  const Scene scene = load(file);
  EXPECT_EQ(scene.meshes.at(0).uvs.at(1), glm::vec2(1.25F, 0));
  EXPECT_EQ(scene.meshes[0].second_uvs.at(1), glm::vec2(1.5F, 0));
  EXPECT_FALSE(scene.materials[0].base_texture.second_uv);
  EXPECT_FALSE(scene.materials[0].normal_texture.second_uv);
  EXPECT_TRUE(scene.materials[0].emission_texture.second_uv);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfTextures, AThirdPlacementUsesTheFirstAndWarnsWithTheMaterialsName) {
  TinyGltf file = textured();
  file.material()["name"] = "busy";
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = moved(0.25);
  file.material()["normalTexture"] = moved(0.5);
  file.material()["occlusionTexture"] = moved(0.75);
  const Scene scene = load(file);
  EXPECT_TRUE(scene.materials[0].normal_texture.second_uv);
  EXPECT_FALSE(scene.materials[0].occlusion_texture.second_uv);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "'busy'");
}

TEST(GltfTextures, CoordinatesComeFromTheSetThatTheTextureNames) {
  TinyGltf file = textured();
  file.primitive()["attributes"]["TEXCOORD_1"] =
      file.add<std::uint8_t>({0, 0, 0, 0, 255, 51, 0, 0, 0, 255, 0, 0}, kUByte, "VEC2", 3, true);
  file.json["bufferViews"].back()["byteStride"] = 4;
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}, {"texCoord", 1}};
  EXPECT_EQ(load(file).meshes[0].uvs.at(1), glm::vec2(1, 0.2F));
  file.material()["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 2;
  const Scene without = load(file);
  EXPECT_TRUE(without.meshes[0].uvs.empty());
  ASSERT_EQ(without.warnings.size(), 1U);
  EXPECT_SAYS(without.warnings[0], "no TEXCOORD_2");
}

TEST(GltfTextures, ATextureTransformTurnsAroundTheOrigin) {
  TinyGltf file = textured();
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 1.5707963267948966}}}}}};
  const glm::vec2 uv = load(file).meshes[0].uvs.at(1);
  EXPECT_NEAR(uv.x, 0, 1e-6F);
  EXPECT_NEAR(uv.y, -1, 1e-6F);
}

TEST(GltfTextures, WebpFallsBackToTheOtherImageOrIsLeftOut) {
  TinyGltf file = textured();
  file.json["extensionsUsed"] = {"EXT_texture_webp"};
  file.json["textures"][0]["extensions"]["EXT_texture_webp"] = {{"source", 7}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  EXPECT_EQ(load(file).textures.size(), 1U);
  file.json["textures"][0].erase("source");
  const Scene scene = load(file);
  EXPECT_FALSE(scene.materials.at(0).base_texture.is_used());
  EXPECT_EQ(scene.warnings.size(), 2U);
}

TEST(GltfTangents, AreMadeWhereANormalMapNeedsThem) {
  TinyGltf file = textured();
  EXPECT_TRUE(load(file).meshes[0].tangents.empty());
  file.material()["normalTexture"] = {{"index", 0}};
  // v grows downwards in the picture, and upwards on this triangle.
  EXPECT_EQ(load(file).meshes[0].tangents, std::vector<glm::vec4>(3, glm::vec4(1, 0, 0, -1)));
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 1, 1, 1, 0, 0}, kFloat, "VEC2", 3);
  EXPECT_EQ(load(file).meshes[0].tangents, std::vector<glm::vec4>(3, glm::vec4(1, 0, 0, 1)));
  file.primitive()["attributes"].erase("TEXCOORD_0");
  const Scene bare = load(file);
  ASSERT_EQ(bare.meshes[0].tangents.size(), 3U) << "some perpendicular direction";
  EXPECT_EQ(glm::dot(glm::vec3(bare.meshes[0].tangents[0]), bare.meshes[0].normals[0]), 0);
}

TEST(GltfTangents, OfTheFileAreKeptIfItHasNormalsToo) {
  TinyGltf file = textured();
  file.material()["normalTexture"] = {{"index", 0}};
  file.primitive()["attributes"]["TANGENT"] =
      file.add<float>({0, 2, 0, -1, 0, 2, 0, -1, 0, 2, 0, -1}, kFloat, "VEC4", 3);
  EXPECT_EQ(load(file).meshes[0].tangents.at(0), glm::vec4(1, 0, 0, -1)) << "glTF: without normals they are computed";
  file.primitive()["attributes"]["NORMAL"] = file.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, "VEC3", 3);
  EXPECT_EQ(load(file).meshes[0].tangents.at(0), glm::vec4(0, 1, 0, -1));
}

TEST(GltfColours, OfVerticesAreReadInEveryForm) {
  TinyGltf file;
  file.primitive()["attributes"]["COLOR_0"] = file.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 3}, kFloat, "VEC3", 3);
  EXPECT_EQ(load(file).meshes[0].colours.at(2), glm::vec4(0, 0, 1, 1));
  file.primitive()["attributes"]["COLOR_0"] =
      file.add<std::uint8_t>({255, 0, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0}, kUByte, "VEC4", 3, true);
  EXPECT_EQ(load(file).meshes[0].colours.at(0), glm::vec4(1, 0, 0, 0.2F));
  file.primitive()["attributes"]["COLOR_0"] =
      file.add<std::uint16_t>(std::vector<std::uint16_t>(12, 65535), kUShort, "VEC4", 3, true);
  EXPECT_TRUE(load(file).meshes[0].colours.empty()) << "all white: nothing to multiply with";
}

}  // namespace
}  // namespace test
