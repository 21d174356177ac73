#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "../support.h"
#include "sim/error.h"
#include "traces/accel/build.h"
#include "traces/accel/build/material_tables.h"
#include "traces/scene/texels.h"

namespace traces {
namespace {

Texture linear_texture(std::uint32_t width, std::uint32_t height, std::vector<std::uint32_t> texels) {
  return {.name = "t", .width = width, .height = height, .texels = std::move(texels), .srgb = false};
}

Texture random_texture(std::uint32_t width, std::uint32_t height, bool srgb) {
  Texture texture{.name = "t", .width = width, .height = height, .srgb = srgb};
  Dice dice(width * 31 + height);
  for (std::uint32_t i = 0; i < width * height; ++i) texture.texels.push_back(dice.below(0xffffffffU));
  return texture;
}

TEST(MipChain, HalvesSidesRoundedDownToASingleTexel) {
  const std::vector<Texture> chain = mip_chain(random_texture(13, 4, true));
  ASSERT_EQ(chain.size(), 4U);
  EXPECT_EQ(chain[0].texels, random_texture(13, 4, true).texels);
  constexpr std::uint32_t kSides[][2] = {{13, 4}, {6, 2}, {3, 1}, {1, 1}};
  for (std::size_t i = 0; i < chain.size(); ++i) {
    EXPECT_EQ(chain[i].width, kSides[i][0]);
    EXPECT_EQ(chain[i].height, kSides[i][1]);
    EXPECT_EQ(chain[i].texels.size(), std::size_t{kSides[i][0]} * kSides[i][1]);
  }
  EXPECT_EQ(mip_chain(random_texture(1, 1, true)).size(), 1U);
}

TEST(MipChain, LevelsKeepEncodingWrapAndFilter) {
  Texture texture = random_texture(2, 2, false);
  texture.wrap_u = Texture::Wrap::kClamp;
  texture.wrap_v = Texture::Wrap::kMirror;
  texture.filter = Texture::Filter::kNearest;
  const Texture level = mip_chain(texture).at(1);
  EXPECT_FALSE(level.srgb);
  EXPECT_EQ(level.wrap_u, Texture::Wrap::kClamp);
  EXPECT_EQ(level.wrap_v, Texture::Wrap::kMirror);
  EXPECT_EQ(level.filter, Texture::Filter::kNearest);
}

TEST(MipChain, ATexelIsTheMeanOfTheFourThatItCovers) {
  const std::vector<Texture> chain =
      mip_chain(linear_texture(2, 2, {0x00000000U, 0x40102030U, 0x80000000U, 0xc0103070U}));
  EXPECT_EQ(chain.at(1).texels, std::vector<std::uint32_t>{0x60081428U});
}

/// Three texels in a row are averaged with equal weights. Of five texels, each half covers 2.5.
TEST(MipChain, OddSidesCountTexelsByHowMuchOfThemIsCovered) {
  EXPECT_EQ(mip_chain(linear_texture(3, 1, {30, 60, 120})).at(1).texels, std::vector<std::uint32_t>{70});
  const std::vector<std::uint32_t> halves = mip_chain(linear_texture(5, 1, {100, 50, 200, 10, 20})).at(1).texels;
  EXPECT_EQ(halves, (std::vector<std::uint32_t>{(200 + 100 + 200 + 2) / 5, (200 + 20 + 40 + 2) / 5}));
}

TEST(MipChain, ColoursAreAveragedAsLightAndAlphaIsNot) {
  const Texture black_and_white{
      .name = "t", .width = 2, .height = 1, .texels = {0xff000000U, 0x00ffffffU}, .srgb = true};
  EXPECT_EQ(mip_chain(black_and_white).at(1).texels[0], 0x80bcbcbcU) << "188 is half the light of 255";
}

TEST(MipChain, TheLastLevelIsTheMeanWhateverTheSides) {
  for (const bool srgb : {false, true}) {
    for (const auto& [width, height] : {std::pair{64U, 64U}, {37U, 23U}, {1U, 9U}, {100U, 1U}}) {
      const Texture texture = random_texture(width, height, srgb);
      const glm::vec4 mean = mean_texel(texture);
      const glm::vec4 last = mean_texel(mip_chain(texture).back());
      for (int k = 0; k < 4; ++k) EXPECT_NEAR(last[k], mean[k], 0.5 / 255 * 2.3) << width << ' ' << height;
    }
  }
}

TEST(MipChain, OneColourStaysThatColourInEveryLevel) {
  for (std::uint32_t code = 0; code < 256; ++code) {
    Texture texture{.name = "t", .width = 7, .height = 5, .srgb = true};
    texture.texels.assign(35, code * 0x01010101U);
    for (const Texture& level : mip_chain(texture)) {
      for (const std::uint32_t texel : level.texels) EXPECT_EQ(texel, code * 0x01010101U);
    }
  }
}

/// Returns a flagged triangle that shows half of a 16 x 16 and of a 3 x 1 texture, and adds an unused white texture.
Scene textured_triangle() {
  Scene scene = one_triangle();
  scene.meshes[0].uvs = {{0, 0}, {4, 0}, {0, 4}};
  scene.textures = {random_texture(16, 16, true), random_texture(3, 1, false)};
  scene.materials = {{.name = "m",
                      .base_texture = {0},
                      .normal_texture = {1},
                      .occlusion_texture = {1},
                      .alpha = Material::Alpha::kMask},
                     {.name = "plain", .alpha = Material::Alpha::kBlend}};
  return scene;
}

MemoryImage with_mips(const Scene& scene, const BvhConfig& config = {}) {
  return build_memory_image(scene, config, 1, nullptr, MipMaps::kOn);
}

TEST(MipMaps, EveryLevelFollowsTheOneOfTwiceItsSize) {
  const MemoryImage image = with_mips(textured_triangle());
  EXPECT_EQ(image.mip_levels, (std::vector<std::uint32_t>{5, 0, 0, 0, 0, 2, 0, 1}));
  ASSERT_EQ(image.textures.size(), 8U);
  EXPECT_EQ(image.materials[0].base_texture, 0U);
  EXPECT_EQ(image.details[0].normal_texture, 5U);
  EXPECT_EQ(image.details[0].occlusion_texture, 5U);
  EXPECT_EQ(image.details[0].emission_texture, kNoTexture);
  EXPECT_EQ(image.materials[1].base_texture, kNoTexture);
  EXPECT_EQ(image.white, 7U);
  // Lines per level, for tiles of 4 x 4 texels: 16, 4, 1, 1, 1 of the first texture; 1, 1 of the second; 1 of the
  // third.
  EXPECT_EQ(image.layout.textures[1].base - image.layout.textures[0].base, 16U * 64);
  EXPECT_EQ(image.layout.textures[5].base - image.layout.textures[1].base, 7U * 64);
  EXPECT_EQ(image.layout.end - image.layout.textures[5].base, 3U * 64);
}

TEST(MipMaps, TakeAThirdMoreThanTheTextures) {
  Scene scene = one_triangle();
  scene.textures = {random_texture(256, 256, true)};
  const auto bytes = [](const MemoryImage& image) { return image.layout.end - image.layout.textures[0].base; };
  EXPECT_NEAR(static_cast<double>(bytes(with_mips(scene))) / static_cast<double>(bytes(build_memory_image(scene))),
              4.0 / 3, 0.002);
}

TEST(MipMaps, ASceneWithoutTexturesIsTheSameWithThem) {
  const MemoryImage image = with_mips(triangle_soup(100, 0.3F));
  EXPECT_FALSE(image.has_mip_maps());
  EXPECT_FLOAT_EQ(glm::length(image.attributes[0].normal[0]), 1.0F);
}

TEST(MipMaps, NormalsAreAsLongAsTheTextureIsDense) {
  Scene scene = textured_triangle();
  for (const InstanceLevels levels : {InstanceLevels::kFlatten, InstanceLevels::kTwoLevel}) {
    const MemoryImage image = with_mips(scene, {.instances = levels});
    for (const glm::vec3& n : image.attributes[0].normal) EXPECT_FLOAT_EQ(glm::length(n), 4.0F);
  }
  scene.instances[0].to_world = glm::scale(glm::mat4(1), {2, 8, 1});
  EXPECT_FLOAT_EQ(glm::length(with_mips(scene).attributes[0].normal[1]), 1.0F);
  scene.meshes[0].uvs = {{0.5F, 0.5F}, {0.5F, 0.5F}, {0.5F, 0.5F}};
  EXPECT_FLOAT_EQ(glm::length(with_mips(scene).attributes[0].normal[2]), kLeastDensity) << "a palette's one texel";
  scene.meshes[0].uvs.clear();
  EXPECT_FLOAT_EQ(glm::length(with_mips(scene).attributes[0].normal[2]), kLeastDensity);
}

TEST(MipMaps, StayWhenTheSceneMoves) {
  for (const InstanceLevels levels : {InstanceLevels::kFlatten, InstanceLevels::kTwoLevel}) {
    for (const BvhUpdate update : {BvhUpdate::kRebuild, BvhUpdate::kRefit}) {
      const BvhConfig config{.update = update, .instances = levels};
      Scene scene = textured_triangle();
      MemoryImage image = with_mips(scene, config);
      scene.instances[0].to_world = glm::scale(glm::mat4(1), glm::vec3(2));
      update_memory_image(scene, config, 1, image);
      const MemoryImage fresh = with_mips(scene, config);
      EXPECT_EQ(image.mip_levels, fresh.mip_levels);
      ASSERT_EQ(image.textures.size(), fresh.textures.size());
      for (std::size_t i = 0; i < fresh.textures.size(); ++i) {
        EXPECT_EQ(image.textures[i].texels, fresh.textures[i].texels);
      }
      EXPECT_EQ(image.attributes[0].normal[0], fresh.attributes[0].normal[0]);
      EXPECT_EQ(image.details[0].normal_texture, fresh.details[0].normal_texture);
    }
  }
}

TEST(MipMaps, RefuseMoreLevelsThanATextureWordNames) {
  Scene scene = one_triangle();
  scene.textures.assign(kMostMipLevels, random_texture(1, 1, true));
  EXPECT_NO_THROW(with_mips(scene));
  scene.textures.push_back(random_texture(1, 1, true));
  EXPECT_THROW(with_mips(scene), sim::InputError);
  EXPECT_NO_THROW(build_memory_image(scene));
}

}  // namespace
}  // namespace traces
