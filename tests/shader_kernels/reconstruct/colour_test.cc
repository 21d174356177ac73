#include <vector>

#include <gtest/gtest.h>

#include "tests/shader_kernels/reconstruct/reconstruct_harness.h"
#include "tests/shader_kernels/showcase.h"

// Tests of `reconstruct` with the colour test, which shades all samples where colours change but geometry does not.

namespace kernels {
namespace {

using traces::RayKind;

Sampled tested(const Stage& stage, const RenderConfig& render, double colour, ReconstructConfig config = {},
               bool record = false) {
  config.colour = colour;
  return reconstruct(stage, render, config, ReconstructProgram::Filters::kApart, nullptr, record);
}

std::uint64_t rays_of(const Sampled& sampled, RayKind kind) { return sampled.rays[static_cast<std::size_t>(kind)]; }

/// Returns a wall with a chequered sign in ambient light.
Stage signed_wall() {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  const std::uint32_t chequers = add_texture(
      scene, 16, true, [](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 != 0 ? 0xffe0e0e0U : 0xff202020U; });
  scene.textures[chequers].filter = traces::Texture::Filter::kNearest;
  add_wall(scene, 0, 2, {.name = "sign", .base_texture = {chequers}});
  add_wall(scene, -0.5F, 12, {.name = "wall", .base_colour = glm::vec3(0.7F)});
  scene.cameras.push_back(traces::look_at("c", {0.3F, 0.2F, 5}, {0, 0, 0}, 0.8F));
  return Stage(scene);
}

TEST(ReconstructColour, AtZeroEverySampleIsShadedAndThePictureIsThatOfFour) {
  for (const char* scene : {"cornell", "teapot"}) {
    const Stage stage(traces::open_scene(scene));
    RenderConfig render = small(40, 24);
    const Sampled all = tested(stage, render, 0), none = tested(stage, render, -1);
    render.samples = SamplePattern::kRotated;
    const Sampled four = stage.full(render, 4);
    for (std::size_t i = 0; i < all.rgb.size(); ++i) EXPECT_NEAR(all.rgb[i], four.rgb[i], 1e-6F) << scene << i;
    EXPECT_EQ(rays_of(all, RayKind::kPrimary), 40U * 24U * (4U + 3U)) << "three once more, to be shaded";
    EXPECT_EQ(all.sampling.traced, none.sampling.traced + 3U * 40U * 24U);
    EXPECT_EQ(all.sampling.correction, 3U * 40U * 24U);
    EXPECT_EQ(all.sampling.passed, 0U);
  }
}

TEST(ReconstructColour, AtOneNothingChangesAsNoContrastIsEnough) {
  const Stage stage(traces::open_scene("cornell"));
  const RenderConfig render = small(40, 24);
  const Sampled one = tested(stage, render, 1), never = tested(stage, render, -1);
  EXPECT_EQ(one.rgb, never.rgb);
  EXPECT_EQ(one.rays, never.rays);
  EXPECT_EQ(one.sampling.checked, 40U * 24U);
  EXPECT_EQ(one.sampling.passed, 40U * 24U);
  EXPECT_EQ(never.sampling.checked, 0U);
}

TEST(ReconstructColour, MendsEdgesOfTexturesAndLeavesThoseOfGeometryToTheFilter) {
  const Stage stage = signed_wall();
  const RenderConfig render = small(96, 96);
  const Sampled truth = stage.full(render, 16);
  const Sampled filtered = tested(stage, render, -1), mended = tested(stage, render, 0.3);
  EXPECT_LT(squared_error(mended.rgb, truth.rgb), 0.5 * squared_error(filtered.rgb, truth.rgb)) << "3 dB";
  // The sign's outline is a depth edge, so only its chequers cause pixels to be listed.
  const std::uint64_t listed = mended.sampling.checked - mended.sampling.passed;
  EXPECT_GT(listed, 500U);
  EXPECT_LT(listed, 96U * 96U / 4U) << "less than the sign";
  EXPECT_EQ(mended.sampling.traced, filtered.sampling.traced + 3 * listed);
}

TEST(ReconstructColour, ComparesOnlySimilarSamples) {
  // Black and white sheets at different depths: the filter separates them, so no pixel is listed.
  Room room;
  room.add(sheet(-10, 0.3F, 0), {.base_colour = glm::vec3(0)}).add(sheet(-10, 10, -3), {.base_colour = glm::vec3(1)});
  EXPECT_EQ(tested(room.stage(), small(32, 32), 0.05).sampling.passed, 32U * 32U);
  // In one plane the sheets are like a texture.
  Room plane;
  plane.add(sheet(-10, 0.3F), {.base_colour = glm::vec3(0)}).add(sheet(0.3F, 10), {.base_colour = glm::vec3(1)});
  EXPECT_EQ(tested(plane.stage(), small(32, 32), 0.05).sampling.passed, 32U * 30U) << "a column on each side";
}

TEST(ReconstructColour, SeesTexturesInMirrors) {
  Room room = mirror();
  room.add(behind(-20, 0.3F), {.base_colour = glm::vec3(0)}).add(behind(0.3F, 20), {.base_colour = glm::vec3(1)});
  const Sampling seen = tested(room.stage(), small(32, 32), 0.3).sampling;
  EXPECT_GT(seen.checked - seen.passed, 16U);
}

TEST(ReconstructColour, ThePictureIsTheSameForEveryTileHaloAttributeStorageAndStream) {
  const Stage stage(showcase_scene());
  for (const std::uint32_t radius : {1U, 2U}) {
    ReconstructConfig c;
    c.radius = radius;
    RenderConfig render = small(37, 29);
    render.tile = 128;
    const Sampled whole = tested(stage, render, 0.2, c);
    EXPECT_LT(whole.sampling.passed, whole.sampling.checked);
    EXPECT_GT(whole.sampling.passed, 0U);
    for (const std::uint32_t tile : {1U, 16U, 40U}) {
      for (const Halo halo : {Halo::kReload, Halo::kRetrace}) {
        render.tile = tile;
        render.streams = tile == 16 ? Streams::kDivergent : Streams::kCompacted;
        c.halo = halo;
        c.attributes = tile == 16 ? AttributeStorage::kDram : AttributeStorage::kTile;
        const Sampled cut = tested(stage, render, 0.2, c, true);
        EXPECT_EQ(cut.rgb, whole.rgb) << "radius " << radius << ", tile " << tile;
        EXPECT_EQ(cut.sampling.passed, whole.sampling.passed);
        EXPECT_EQ(cut.sampling.correction, whole.sampling.correction);
      }
    }
  }
}

}  // namespace
}  // namespace kernels
