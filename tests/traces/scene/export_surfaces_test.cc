#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/traces/scene/exported.h"
#include "traces/scenes/builtin.h"

namespace test {
namespace {

using nlohmann::json;
using traces::Material;
using traces::Scene;

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

}  // namespace
}  // namespace test
