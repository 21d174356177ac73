#include <cmath>

#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/images.h"
#include "traces/scene/lights.h"

namespace test {
namespace {

using traces::Scene;

traces::Material material_of(const nlohmann::json& material) {
  TinyGltf file;
  file.material() = material;
  return load(file).materials.at(0);
}

nlohmann::json surface(double metallic, double roughness) {
  return {{"pbrMetallicRoughness",
           {{"metallicFactor", metallic}, {"roughnessFactor", roughness}, {"baseColorFactor", {0.5, 0.25, 0.75, 1}}}}};
}

TEST(GltfMaterial, ASmoothMetalMirrorsAllTintedByItsColour) {
  const traces::Material m = material_of(surface(1, 0));
  EXPECT_FLOAT_EQ(m.mirror, 1);
  EXPECT_FLOAT_EQ(m.mirror_tint.y, 0.25F);
}

TEST(GltfMaterial, ASmoothDielectricMirrorsALittleWhite) {
  const traces::Material m = material_of(surface(0, 0));
  EXPECT_NEAR(m.mirror, 0.08F, 1e-6F);
  EXPECT_EQ(m.mirror_tint, glm::vec3(1));
  EXPECT_FLOAT_EQ(m.base_colour.x, 0.5F);
}

TEST(GltfMaterial, RoughSurfacesMirrorNothing) {
  for (const double metallic : {0.0, 1.0}) EXPECT_EQ(material_of(surface(metallic, 0.5)).mirror, 0);
  EXPECT_EQ(material_of(surface(0, 0.45)).mirror, 0) << "a share below 2 % is dropped";
}

TEST(GltfMaterial, GlassComesFromTransmissionAndIor) {
  nlohmann::json glass = surface(0, 0);
  glass["extensions"] = {{"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
                         {"KHR_materials_ior", {{"ior", 1.33}}}};
  const traces::Material m = material_of(glass);
  EXPECT_FLOAT_EQ(m.transmission, 0.9F);
  EXPECT_FLOAT_EQ(m.ior, 1.33F);
  EXPECT_EQ(m.mirror, 0);
}

TEST(GltfMaterial, ClearCoatAddsAMirrorLayer) {
  nlohmann::json coated = surface(0, 1);
  coated["extensions"]["KHR_materials_clearcoat"] = {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0}};
  EXPECT_NEAR(material_of(coated).mirror, 0.08F, 1e-6F);
}

TEST(GltfMaterial, APrimitiveWithoutMaterialGetsTheDefault) {
  const Scene scene = load(TinyGltf());
  EXPECT_EQ(scene.materials.at(scene.meshes[0].material).base_colour, glm::vec3(1));
}

TEST(GltfTexture, ABaseTextureIsDecodedWithItsWrapModesAndTransform) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 2, 1, std::vector<std::uint8_t>{255, 0, 0, 0, 0, 255});
  TinyGltf file;
  file.json["images"] = {
      {{"bufferView", file.add_view(read_bytes(folder.path() / "a.png"))}, {"mimeType", "image/png"}}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}, {"scale", {2, 3}}}}}}};
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  const Scene scene = load(file);
  ASSERT_EQ(scene.textures.size(), 1U);
  EXPECT_EQ(scene.materials[0].base_texture.texture, 0U);
  EXPECT_EQ(scene.textures[0].texels, (std::vector<std::uint32_t>{0xff0000ffU, 0xffff0000U}));
  EXPECT_EQ(scene.textures[0].wrap_u, traces::Texture::Wrap::kClamp);
  EXPECT_EQ(scene.textures[0].wrap_v, traces::Texture::Wrap::kMirror);
  EXPECT_EQ(scene.meshes[0].uvs[1], glm::vec2(2.5F, 0));
  EXPECT_EQ(scene.meshes[0].uvs[2], glm::vec2(0.5F, 3));
}

TEST(GltfTexture, ATextureUsedByTwoMaterialsIsStoredOnce) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 1, 1, std::vector<std::uint8_t>{9, 9, 9});
  TinyGltf file;
  file.json["images"] = {{{"uri", "a.png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  file.json["materials"].push_back(file.json["materials"][0]);
  EXPECT_EQ(traces::load_gltf(folder.write("a.gltf", file.text())).textures.size(), 1U);
}

TEST(GltfCamera, CamerasKeepNameAndAngleAndLoseScale) {
  TinyGltf file;
  file.json["cameras"] = {
      {{"type", "perspective"}, {"name", "front"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}},
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  file.json["nodes"].push_back({{"camera", 0}, {"scale", {3, 3, 3}}, {"translation", {0, 0, 4}}});
  file.json["nodes"].push_back({{"camera", 1}, {"name", "from the side"}});
  file.json["scenes"][0]["nodes"] = {0, 1, 2};
  const Scene scene = load(file);
  ASSERT_EQ(scene.cameras.size(), 2U);
  EXPECT_EQ(scene.cameras[0].name, "front");
  EXPECT_EQ(scene.cameras[1].name, "from the side");
  EXPECT_FLOAT_EQ(scene.cameras[0].vertical_fov, 0.5F);
  EXPECT_EQ(scene.cameras[0].to_world[2], glm::vec4(0, 0, 1, 0));
  EXPECT_EQ(scene.cameras[0].to_world[3], glm::vec4(0, 0, 4, 1));
}

TEST(GltfCamera, AFileWithoutCameraGetsOneThatSeesEverything) {
  const Scene scene = load(TinyGltf());
  ASSERT_EQ(scene.cameras.size(), 1U);
  const glm::mat4 to_camera = glm::inverse(scene.cameras[0].to_world);
  for (const glm::vec3& p : scene.meshes[0].positions) {
    const glm::vec3 seen(to_camera * glm::vec4(p, 1));
    EXPECT_LT(std::abs(seen.y), -seen.z * std::tan(scene.cameras[0].vertical_fov / 2));
    EXPECT_LT(std::abs(seen.x), -seen.z * std::tan(scene.cameras[0].vertical_fov / 2));
  }
}

Scene with_lights(const nlohmann::json& lights) {
  TinyGltf file;
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = lights;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    file.json["nodes"].push_back(
        {{"translation", {0, 0, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
    file.json["scenes"][0]["nodes"].push_back(i + 1);
  }
  return load(file);
}

TEST(GltfLight, PunctualLightsKeepKindPlaceAndRelativeStrength) {
  const Scene scene = with_lights({{{"type", "point"}, {"intensity", 1000}, {"color", {1, 0.5, 0}}},
                                   {{"type", "spot"}, {"intensity", 500}, {"spot", {{"outerConeAngle", 0.5}}}},
                                   {{"type", "directional"}, {"intensity", 2000}}});
  ASSERT_EQ(scene.lights.size(), 3U);
  EXPECT_EQ(scene.lights[0].kind, traces::Light::Kind::kPoint);
  EXPECT_EQ(scene.lights[0].position, glm::vec3(0, 0, 3));
  EXPECT_NEAR(scene.lights[0].intensity.x / scene.lights[1].intensity.x, 2, 1e-5);
  EXPECT_NEAR(scene.lights[0].intensity.y / scene.lights[0].intensity.x, 0.5, 1e-5);
  EXPECT_EQ(scene.lights[1].kind, traces::Light::Kind::kSpot);
  EXPECT_NEAR(scene.lights[1].cos_outer, std::cos(0.5), 1e-6);
  EXPECT_EQ(scene.lights[1].cos_inner, 1);
  EXPECT_EQ(scene.lights[2].direction, glm::vec3(0, 0, -1));
}

TEST(GltfLight, TheUnitOfTheFileDoesNotMatter) {
  const Scene dim = with_lights({{{"type", "point"}, {"intensity", 1}}});
  const Scene bright = with_lights({{{"type", "point"}, {"intensity", 54351}}});
  EXPECT_NEAR(dim.lights.at(0).intensity.x / bright.lights.at(0).intensity.x, 1, 1e-4);
  EXPECT_GT(dim.lights[0].intensity.x, 1) << "three units away, about the target irradiance arrives";
  EXPECT_LT(dim.lights[0].intensity.x, 20);
}

TEST(GltfLight, WithoutLightsThereIsASunAndABrightSky) {
  const Scene scene = load(TinyGltf());
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].kind, traces::Light::Kind::kDirectional);
  EXPECT_GT(scene.ambient.x, traces::kAmbient);
}

}  // namespace
}  // namespace test
