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

// Tests of materials that are read from KHR_materials_* extensions and alphaMode.

using nlohmann::json;
using traces::Material;

Material read_material(const json& material) {
  TinyGltf file;
  file.material() = material;
  return load(file).materials.at(0);
}

json smooth(const json& extensions) {
  return {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}}, {"extensions", extensions}};
}

TEST(GltfAlpha, BlendedSurfacesKeepTheirOpacity) {
  const Material m =
      read_material({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.25}}}}});
  EXPECT_EQ(m.alpha, Material::Alpha::kBlend);
  EXPECT_EQ(m.opacity, 0.25F);
  EXPECT_EQ(m.transmission, 0);
}

TEST(GltfAlpha, CutOutsKeepTheirCutoff) {
  const Material m = read_material({{"alphaMode", "MASK"}});
  EXPECT_EQ(m.alpha, Material::Alpha::kMask);
  EXPECT_EQ(m.alpha_cutoff, 0.5F);
  EXPECT_EQ(read_material({{"alphaMode", "MASK"}, {"alphaCutoff", 0.75}}).alpha_cutoff, 0.75F);
}

TEST(GltfAlpha, OpaqueSurfacesIgnoreTheirAlpha) {
  const Material m = read_material({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.25}}}}});
  EXPECT_EQ(m.alpha, Material::Alpha::kOpaque);
  EXPECT_EQ(m.opacity, 1);
}

TEST(GltfVolume, LightFadesToTheAttenuationColourInTheAttenuationDistance) {
  const Material m = read_material(
      smooth({{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_volume",
               {{"thicknessFactor", 0.1}, {"attenuationDistance", 2}, {"attenuationColor", {0.5, 1, 0}}}}}));
  EXPECT_NEAR(std::exp(-m.absorption.x * 2), 0.5, 1e-6);
  EXPECT_EQ(m.absorption.y, 0);
  EXPECT_GT(m.absorption.z, 5) << "black after two units, but finite";
  EXPECT_TRUE(std::isfinite(m.absorption.z));
  EXPECT_EQ(m.ior, 1.5F);
}

TEST(GltfVolume, AThinSheetNeitherBendsNorAbsorbsButMirrors) {
  const Material m = read_material(
      smooth({{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_ior", {{"ior", 1.5}}},
              {"KHR_materials_volume", {{"attenuationDistance", 2}, {"attenuationColor", {0.5, 0.5, 0.5}}}}}));
  EXPECT_EQ(m.absorption, glm::vec3(0));
  EXPECT_EQ(m.ior, 1);
  EXPECT_NEAR(m.mirror, 0.08F, 1e-6F);
}

TEST(GltfSpecular, FactorAndColourScaleWhatADielectricMirrors) {
  EXPECT_NEAR(read_material(smooth(json::object())).dielectric, 0.08F, 1e-6F);
  EXPECT_NEAR(read_material(smooth({{"KHR_materials_specular", {{"specularFactor", 0.5}}}})).dielectric, 0.04F, 1e-6F);
  EXPECT_NEAR(read_material(smooth({{"KHR_materials_specular", {{"specularColorFactor", {1.5, 0, 0}}}}})).dielectric,
              0.04F, 1e-6F);
  EXPECT_EQ(read_material(smooth({{"KHR_materials_specular", {{"specularFactor", 0}}}})).mirror, 0);
}

TEST(GltfClearCoat, IsSeparateFromTheLayerBelow) {
  const Material m = read_material(
      smooth({{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.1}}}}));
  EXPECT_NEAR(m.coat, 0.04F, 1e-6F);
  EXPECT_NEAR(m.dielectric, 0.08F, 1e-6F);
  EXPECT_NEAR(m.mirror, 0.08F + 0.92F * 0.04F, 1e-6F);
}

TEST(GltfUnlit, ShinesWithItsColourAndLightsNothing) {
  TinyGltf file;
  file.material() = {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0.5, 0.25, 1}}, {"roughnessFactor", 0}}},
                     {"extensions", {{"KHR_materials_unlit", json::object()}}}};
  const Scene scene = load(file);
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.emission, glm::vec3(1, 0.5F, 0.25F));
  EXPECT_EQ(m.base_colour, glm::vec3(0));
  EXPECT_EQ(m.mirror, 0);
  EXPECT_FALSE(m.casts_light);
  ASSERT_EQ(scene.lights.size(), 1U);
  EXPECT_EQ(scene.lights[0].kind, traces::Light::Kind::kDirectional) << "the default sun, no lamp";
}

TEST(GltfUnlit, VertexColoursCountByTheirMean) {
  TinyGltf file;
  file.material() = {{"extensions", {{"KHR_materials_unlit", json::object()}}}};
  file.primitive()["attributes"]["COLOR_0"] = file.add<float>({1, 0, 0, 0, 1, 0, 0.5, 0.5, 0}, kFloat, "VEC3", 3);
  file.json["meshes"][0]["primitives"].push_back(file.primitive());
  file.json["meshes"][0]["primitives"][1]["attributes"].erase("COLOR_0");
  const Scene scene = load(file);
  EXPECT_EQ(scene.materials.at(scene.meshes.at(0).material).emission, glm::vec3(0.5F, 0.5F, 0));
  EXPECT_EQ(scene.materials.at(scene.meshes.at(1).material).emission, glm::vec3(1));
}

TEST(GltfEmission, ALampsTextureCountsForTheLightByItsMean) {
  const TempFolder folder;
  traces::write_png(folder.path() / "a.png", 2, 1, std::vector<std::uint8_t>{255, 255, 255, 0, 0, 0});
  TinyGltf file;
  file.json["images"] = {{{"uri", "a.png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.primitive()["attributes"]["TEXCOORD_0"] = file.add<float>({0, 0, 1, 0, 0, 1}, kFloat, "VEC2", 3);
  file.material()["emissiveFactor"] = {1, 1, 1};
  file.material()["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = 8;
  file.json["nodes"].push_back({{"mesh", 1}, {"translation", {0, 0, -2}}});
  file.json["scenes"][0]["nodes"] = {0, 1};
  file.json["meshes"].push_back(file.json["meshes"][0]);
  file.json["materials"].push_back(file.json["materials"][0]);
  file.json["meshes"][1]["primitives"][0]["material"] = 1;
  file.json["materials"][1]["emissiveTexture"] = {{"index", 0}};
  const Scene scene = traces::load_gltf(folder.write("a.gltf", file.text()));
  ASSERT_EQ(scene.lights.size(), 2U);
  EXPECT_NEAR(scene.lights[0].intensity.x / scene.lights[1].intensity.x, 2, 1e-5);
  EXPECT_EQ(scene.materials[1].emission, glm::vec3(1)) << "shown no brighter than white";
}

TEST(GltfExtensions, UnsupportedOnesAreNamedInAWarning) {
  for (const char* name :
       {"KHR_materials_dispersion", "KHR_materials_sheen", "KHR_materials_iridescence", "KHR_materials_anisotropy",
        "KHR_materials_diffuse_transmission", "KHR_materials_pbrSpecularGlossiness"}) {
    TinyGltf file;
    file.json["extensionsUsed"] = {name};
    const Scene scene = load(file);
    ASSERT_EQ(scene.warnings.size(), 1U);
    EXPECT_SAYS(scene.warnings[0], name);
  }
}

TEST(GltfExtensions, ContentOfUnknownExtensionsIsIgnored) {
  TinyGltf file;
  file.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
  // In this extension the property is a list, in KHR_materials_specular a number.
  file.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"] = {
      {"specularFactor", {0.5, 0.5, 0.5}}, {"glossinessFactor", "odd"}, {"diffuseTexture", {{"index", -1}}}};
  const Scene scene = load(file);
  ASSERT_EQ(scene.warnings.size(), 1U);
  EXPECT_SAYS(scene.warnings[0], "the extension KHR_materials_pbrSpecularGlossiness is not supported and left out");
}

TEST(GltfExtensions, OfRequiredVariantsTheDefaultIsShown) {
  TinyGltf file;
  file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_materials_variants"};
  file.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "blue"}}};
  file.material()["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 1};
  file.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 1, 1}}}}});
  file.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}}};
  const Scene scene = load(file);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.materials.at(scene.meshes.at(0).material).base_colour, glm::vec3(1, 0, 0));
}

}  // namespace
}  // namespace test
