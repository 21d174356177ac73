#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "sampled_room.h"
#include "showcase.h"

// Checks of what textures show, and which check a sample is traced for.

namespace kernels {
namespace {

TEST(TextureChecks, AnOcclusionMapIsSampledBetweenItsReferences) {
  Room room;
  const std::uint32_t dirt = add_texture(
      room.scene, 4, false, [](std::uint32_t x, std::uint32_t y) { return 0xff000000U + 64 * ((x + y) % 4); });
  const traces::Mesh wall = traces::make_quad("wall", {-1.2F, -1.2F, 0}, {2.4F, 0, 0}, {0, 2.4F, 0}, 1);
  room.add(wall, {.base_colour = glm::vec3(0.7F), .occlusion_texture = {dirt}});
  UndersampleConfig kim;
  kim.position = 1000;
  kim.texture = 0;
  for (const Fusion fusion : {Fusion::kOn, Fusion::kOff}) {
    RenderConfig render = small(16, 16);
    render.fusion = fusion;
    const Stage stage = room.stage();
    const Sampled run = stage.undersample(render, kim);
    EXPECT_EQ(failing(run.sampling), Names{});
    EXPECT_GT(run.sampling.passed, 0U);
    const Sampled full = stage.full(render);
    for (std::size_t i = 0; i < full.rgb.size(); ++i) EXPECT_NEAR(run.rgb[i], full.rgb[i], 1e-5F);
    EXPECT_GT(std::ranges::max(full.rgb), 2 * std::ranges::min(full.rgb)) << "which is no even wall";
  }
  EXPECT_EQ(failing(room.multi()), Names{});
}

TEST(TextureChecks, AnOcclusionMapFailsByTextureWhereItsCoordinatesWrapAndByDetailIfTheyAreOthers) {
  Room room;
  const std::uint32_t dirt = add_texture(room.scene, 2, false, [](auto, auto) { return 0xff808080U; });
  const traces::Mesh wall = traces::make_quad("wall", {-10.5F, -10.5F, 0}, {21, 0, 0}, {0, 21, 0}, 1, 20);
  EXPECT_EQ(failing(Room(room).add(wall, {.occlusion_texture = {dirt}}).under()), Names{"texture"});
  traces::Mesh second = sheet(-10, 10);
  second.second_uvs.assign(second.positions.size(), {0, 0});
  room.add(second, {.occlusion_texture = {.texture = dirt, .second_uv = true}});
  EXPECT_EQ(failing(room.under()), Names{"detail"});
  EXPECT_EQ(room.under().passed, 0U);
}

/// A wall whose texture is dark to the left and bright to the right.
Room two_greys() {
  Room room;
  const std::uint32_t grey = add_texture(
      room.scene, 2, true, [](std::uint32_t x, std::uint32_t) { return x == 0 ? 0xff202020U : 0xffe0e0e0U; });
  room.scene.textures[grey].filter = traces::Texture::Filter::kNearest;
  const traces::Mesh wall = traces::make_quad("wall", {-10.5F, -10.5F, 0}, {21, 0, 0}, {0, 21, 0}, 1);
  return room.add(wall, {.base_texture = {grey}});
}

TEST(TextureChecks, ATexturesEdgeFailsByTextureIfColoursAreCompared) {
  const Room room = two_greys();
  MultirateConfig lee;
  EXPECT_EQ(failing(room.multi(lee)), Names{}) << "not compared";
  lee.texture = 0.5;
  EXPECT_EQ(failing(room.multi(lee)), Names{"texture"});
  EXPECT_EQ(failed(room.multi(lee), Check::kTexture), 8U) << "one in each row of references";
  EXPECT_EQ(room.multi(lee).rough, 0U);
  lee.texture = 1.4;
  EXPECT_EQ(failing(room.multi(lee)), Names{}) << "sqrt(3) times 0.75";
  lee.secondary_checks = false;
  lee.texture = 0.5;
  EXPECT_EQ(failing(room.multi(lee)), Names{"texture"});
  Room lit = Room().add(sheet(-10, 10));
  lit.scene.lights.push_back({.position = {0, 0, 0.2F}, .intensity = glm::vec3(0.2F)});
  lee.texture = 0.01;
  EXPECT_EQ(failing(lit.multi(lee)), Names{}) << "no texture";
}

TEST(TextureChecks, ATexturesEdgeThatPassesIsRoughForTheRateAlone) {
  const Room room = two_greys();
  MultirateConfig lee;
  lee.rate_control = RateControl::kHysteresis;
  lee.rate_texture = 2;
  const Sampling without = room.multi(lee);
  lee.rate_texture = 0.5;
  const Sampling with = room.multi(lee);
  EXPECT_EQ(with.passed, without.passed);
  EXPECT_EQ(without.rough, 0U);
  EXPECT_EQ(with.rough, 8U) << "one in each row of references";
  EXPECT_FLOAT_EQ(with.similar[0], 1 - static_cast<float>(with.rough) / static_cast<float>(with.checked));
  EXPECT_EQ(without.similar[0], 1);
  lee.texture = 0.5;
  EXPECT_EQ(room.multi(lee).rough, 0U) << "what is traced needs no finer rate";
}

TEST(FirstFailed, ASampleIsTracedForTheFirstCheckThatItFails) {
  const Room far = Room().add(both_sides(sheet(-10, 0, -2), sheet(0, 10)));
  const Sampling s = far.under();
  EXPECT_EQ(failed(s, Check::kPosition), failed(s, Check::kConvexity));
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kPosition)], failed(s, Check::kPosition));
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kConvexity)], 0U);
  EXPECT_EQ(s.first_failed[static_cast<std::size_t>(Check::kBorder)], failed(s, Check::kBorder));
  const Sampling all = Stage(showcase_scene()).undersample(small(61, 35), {}).sampling;
  EXPECT_EQ(std::accumulate(all.first_failed.begin(), all.first_failed.end(), std::uint64_t{0}),
            all.checked - all.passed + failed(all, Check::kBorder));
}

}  // namespace
}  // namespace kernels
