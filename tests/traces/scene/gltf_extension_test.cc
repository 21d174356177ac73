#include <cmath>

#include <gtest/gtest.h>

#include "tests/traces/scene/tiny_gltf_file.h"
#include "traces/scene/images.h"
#include "traces/scene/lights.h"

// Tests of materials that are read from KHR_materials_* extensions and alphaMode.

namespace test {
namespace {

using nlohmann::json;
using traces::Material;
using traces::Scene;

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
