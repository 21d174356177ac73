#include <array>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/programs/adaptive/supersample.h"
#include "sim/hash.h"

namespace kernels {
namespace {

/// Returns the exact inverse of the sRGB encoding.
float linear(float x) { return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F); }

TEST(Contrast, IsTheDifferenceOverTheSumOfEncodedColours) {
  EXPECT_NEAR(channel_contrast<float>(linear(0.2F), linear(0.6F), linear(0.2F), linear(0.3F)), 0.5F, 2e-3F);
  EXPECT_NEAR(channel_contrast<float>(linear(0.5F), 7, 1, 2), 1.0F / 3, 2e-3F);
  EXPECT_EQ(channel_contrast<float>(0, 0, 0.01F, 0), 1.0F);
  EXPECT_EQ(channel_contrast<float>(0, 0, 0, 0), 0.0F);
  EXPECT_EQ(channel_contrast<float>(0.7F, 0.7F, 0.7F, 0.7F), 0.0F);
}

/// Returns the verdict word of sub-pixel 1 of the first of two pixels, which is compared with the second pixel. The
/// pixels have the encoded colours 0 and `colour`, and the objects 1 and `object`.
std::uint32_t verdict_between(const Vec3<float>& colour, std::uint32_t object, double object_threshold) {
  std::array<TraitsRecord<float>, 2> traits{};
  traits[0].normal = traits[1].normal = {0, 0, 1};
  traits[0].object = 1;
  traits[1].object = object;
  auto secondary = traits;
  secondary[1].object = 1;
  std::array<ColourRecord<float>, 2> colours{};
  colours[0].rgb = {linear(0.5F), linear(0.5F), linear(0.5F)};
  colours[1].rgb = {linear(colour.x), linear(colour.y), linear(colour.z)};
  std::array<std::uint32_t, 8> verdicts{};
  TestSubpixels::Ports<float> ports;
  ports.finished = {2, 0.5F, 0, 2, 0, 1, 0, 0};
  ports.traits.bind(traits.data());
  ports.secondary.bind(secondary.data());
  ports.colours.bind(colours.data());
  ports.verdicts.bind(verdicts.data());
  ports.thresholds.fill(kNever);
  ports.thresholds[1] = static_cast<float>(object_threshold);
  ports.thresholds[0] = 0.5F;
  ports.same_normal = 0.9F;
  ports.compared = 0x1ff;
  ports.focus = 0;
  ports.textured = kTexturedObject;
  for (std::uint32_t i = 0; i < 8; ++i) TestSubpixels::body<float>(i, ports);
  EXPECT_EQ(active_bit<float>(verdicts[0]), 0U) << "has no neighbour";
  return verdicts[1];
}

TEST(TestSubpixelsKernel, EachChannelHasItsWeight) {
  // The contrast of 0.5 and x is (x - 0.5) / (x + 0.5). Half of the factors: 0.68, 0.51, 1.02.
  const auto active = [](const Vec3<float>& colour) { return active_bit<float>(verdict_between(colour, 1, 1)) == 1; };
  EXPECT_FALSE(active({0.5F, 0.5F, 0.5F}));
  EXPECT_FALSE(active({0.1F, 0.5F, 0.5F}));   // 0.667
  EXPECT_TRUE(active({0.09F, 0.5F, 0.5F}));   // 0.695
  EXPECT_FALSE(active({0.5F, 0.17F, 0.5F}));  // 0.493
  EXPECT_TRUE(active({0.5F, 0.15F, 0.5F}));   // 0.538
  EXPECT_FALSE(active({0.5F, 0.5F, 0}));      // 1
}

TEST(TestSubpixelsKernel, TheThresholdOfTheDifferingAttributeApplies) {
  const Vec3<float> same{0.5F, 0.5F, 0.5F};
  EXPECT_EQ(verdict_between(same, 2, 0), attribute_bit(Attribute::kObject) | 1U << kActiveShift);
  EXPECT_EQ(verdict_between(same, 2, 0.05), attribute_bit(Attribute::kObject));
  EXPECT_EQ(verdict_between({0.55F, 0.55F, 0.55F}, 2, 0.04), attribute_bit(Attribute::kObject) | 1U << kActiveShift);
  EXPECT_EQ(verdict_between({0.55F, 0.55F, 0.55F}, 2, 0.05), attribute_bit(Attribute::kObject));
  EXPECT_EQ(verdict_between({0, 0, 0}, 2, 1), attribute_bit(Attribute::kObject));
  EXPECT_EQ(verdict_between({0, 0, 0}, 1, 1), attribute_bit(Attribute::kColour) | 1U << kActiveShift);
}

TEST(SameNormal, IsTheLeastDotProductOfNormalsThatDoNotDiffer) {
  const TraitsRecord<float> one{{0, 0, 1}, 1, 0}, other{{0.6F, 0, 0.8F}, 1, 0};
  EXPECT_EQ(disagreeing_attributes<float>(one, other, 0.9F, 0), 2U);
  EXPECT_EQ(disagreeing_attributes<float>(one, other, 0.8F, 0), 0U);
  EXPECT_EQ(disagreeing_attributes<float>(one, one, 1, 0), 0U);
  EXPECT_EQ(disagreeing_attributes<float>(one, one, 2, 0), 2U) << "nothing reaches it";
}

TEST(SameNormal, DecidesWhereSupersampleFindsNormalsToDiffer) {
  const traces::Scene scene = traces::open_scene("teapot");
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  SupersampleConfig c;
  c.colour = c.object = c.shadow = c.texture = 1;
  c.secondary_object = c.secondary_normal = c.secondary_shadow = c.secondary_texture = 1;
  c.normal = 0;
  const auto active = [&](double same_normal) {
    c.same_normal = same_normal;
    SupersampleProgram program(image, scene.cameras.front(), small(24, 16), c, 0);
    run_tiles(program, tracer, false, [](const TileResult&) {});
    return 24U * 16U - program.sampling().active[0];
  };
  EXPECT_EQ(active(-1), 0U);
  EXPECT_GT(active(0.9), active(0.5));
  EXPECT_GT(active(0.5), 0U);
  EXPECT_EQ(active(2), 24U * 16U);
}

TEST(Packing, AChunkNeverSplitsAPixelAndNothingIsLost) {
  constexpr std::uint32_t kWidth = 21, kHeight = 10, kPixels = kWidth * kHeight;
  for (std::uint32_t seed = 0; seed < 10; ++seed) {
    std::vector<std::uint32_t> verdicts(4 * (kPixels + 4 * kWidth)), list(4 * kPixels + 64), masters(kPixels + 1),
        fills(64);
    std::set<std::uint32_t> wanted;
    for (std::uint32_t i = 0; i < verdicts.size(); ++i) {
      if (sim::hash(seed, i) % 10 >= seed) continue;
      verdicts[i] = 1U << kActiveShift;
      if (i < 4 * kPixels) wanted.insert(i);
    }
    PackSubpixels::Ports<float> ports;
    ports.across = 3;
    ports.inverse_across = 1.0F / 3;
    ports.width = kWidth;
    ports.height = kHeight;
    ports.verdicts.bind(verdicts.data());
    ports.active.bind(list.data());
    ports.masters.bind(masters.data());
    ports.fills.bind(fills.data());
    for (std::uint32_t i = 0; i < 3 * 3 * 32; ++i) PackSubpixels::body<float>(i, ports);

    std::set<std::uint32_t> listed;
    std::set<std::uint32_t> finished;
    std::uint32_t masters_so_far = 0;
    for (std::uint32_t chunk = 0; chunk * kChunk < static_cast<std::uint32_t>(ports.list_end.value); ++chunk) {
      const std::uint32_t fill = fills[chunk] & 255U;
      ASSERT_LE(fill, kChunk);
      std::set<std::uint32_t> pixels;
      for (std::uint32_t i = 0; i < fill; ++i) {
        const std::uint32_t index = chunk * kChunk + i;
        EXPECT_TRUE(listed.insert(list[index]).second);
        EXPECT_EQ(verdicts[list[index]] >> kIndexShift, index);
        pixels.insert(list[index] / 4);
      }
      for (const std::uint32_t pixel : pixels) EXPECT_TRUE(finished.insert(pixel).second) << "cut by a chunk";
      const std::uint32_t end = fills[chunk] >> PackSubpixels::kFillBits;
      EXPECT_EQ(std::set(masters.begin() + masters_so_far, masters.begin() + end), pixels);
      masters_so_far = end;
    }
    EXPECT_EQ(listed, wanted);
  }
}

}  // namespace
}  // namespace kernels
