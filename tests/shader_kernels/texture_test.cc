#include <cmath>

#include <gtest/gtest.h>

#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"

namespace kernels {
namespace {

using Wrap = traces::Texture::Wrap;

float exactly_decoded(float x) { return x <= 0.04045F ? x / 12.92F : std::pow((x + 0.055F) / 1.055F, 2.4F); }
float exactly_encoded(float x) { return x <= 0.0031308F ? x * 12.92F : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F; }

/// Runs the kernel shade_textured for one surface of white base colour, and appends its reads to `log`.
float fetch_red(const traces::Texture& texture, float u, float v, std::vector<traces::Access>* log = nullptr) {
  const std::uint32_t stream[] = {0};
  const AxisRecord<float> axes[] = {axis_record(texture.width, texture.wrap_u, texture.filter),
                                    axis_record(texture.height, texture.wrap_v, texture.filter)};
  std::uint32_t slots[] = {stream[0]};
  TexcoordRecord<float> texcoords[] = {{u, v, 0}};
  DiffuseRecord<float> mattes[] = {{{1, 1, 1}, 7}};
  ShadeTextured<>::Ports<float> ports;
  ports.textured.bind(slots);
  ports.texcoords.bind(texcoords);
  ports.mattes.bind(mattes);
  ports.axes.bind(axes);
  ports.texels.bind_raw(&texture, log);
  const std::vector<SrgbCodeRecord<float>> codes = srgb_code_records();
  ports.srgb_codes.bind(codes.data());
  ShadeTextured<>::body<float>(0, ports);
  EXPECT_EQ(mattes[0].classes, 7U);
  return mattes[0].diffuse.x;
}

/// Returns a texture whose red channel at texel (x, y) is 16 * (4 y + x).
traces::Texture ramp(Wrap wrap) {
  traces::Texture t;
  t.width = t.height = 4;
  for (std::uint32_t i = 0; i < 16; ++i) t.texels.push_back(16 * i);
  t.wrap_u = t.wrap_v = wrap;
  return t;
}
float texel(std::uint32_t x, std::uint32_t y) { return exactly_decoded(static_cast<float>(16 * (4 * y + x)) / 255); }

constexpr float kTolerance = 1e-6F;

TEST(Textures, ATexelsCentreIsThatTexelAndTheTopRowIsFirst) {
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
    for (std::uint32_t y = 0; y < 4; ++y) {
      for (std::uint32_t x = 0; x < 4; ++x) {
        const float u = (static_cast<float>(x) + 0.5F) / 4, v = (static_cast<float>(y) + 0.5F) / 4;
        EXPECT_NEAR(fetch_red(ramp(wrap), u, v), texel(x, y), kTolerance);
      }
    }
  }
}

TEST(Textures, BetweenTexelsColoursAreBlendedInLinearLight) {
  EXPECT_NEAR(fetch_red(ramp(Wrap::kRepeat), 0.25F, 0.125F), (texel(0, 0) + texel(1, 0)) / 2, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kRepeat), 0.5F, 0.5F), (texel(1, 1) + texel(2, 1) + texel(1, 2) + texel(2, 2)) / 4,
              kTolerance);
}

TEST(Textures, BordersFollowTheWrapMode) {
  const float last = texel(3, 0), first = texel(0, 0);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kRepeat), 0, 0.125F), (first + last) / 2, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kMirror), 0, 0.125F), first, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kClamp), 0, 0.125F), first, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kClamp), 1, 0.125F), last, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kClamp), 7, 0.125F), last, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kClamp), -7, 0.125F), first, kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kRepeat), 2.125F, 0.125F), texel(0, 0), kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kRepeat), -0.125F, 0.125F), texel(3, 0), kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kMirror), 1.125F, 0.125F), texel(3, 0), kTolerance);
  EXPECT_NEAR(fetch_red(ramp(Wrap::kMirror), -0.375F, 0.125F), texel(1, 0), kTolerance);
}

TEST(Textures, NearestTakesTheTexelAtTheCoordinate) {
  std::vector<traces::Access> log;
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp}) {
    traces::Texture texture = ramp(wrap);
    texture.filter = traces::Texture::Filter::kNearest;
    for (std::uint32_t x = 0; x < 4; ++x) {
      for (const float within : {0.001F, 0.3F, 0.999F}) {
        const float u = (static_cast<float>(x) + within) / 4;
        EXPECT_NEAR(fetch_red(texture, u, 0.6F, &log), texel(x, 2), kTolerance) << u;
        EXPECT_EQ(log.back().element, log.back().element2);
      }
    }
    // At the edges of the texture, and far outside.
    EXPECT_NEAR(fetch_red(texture, 0, 0, &log), texel(0, 0), kTolerance);
    EXPECT_NEAR(fetch_red(texture, 1, 0, &log), wrap == Wrap::kRepeat ? texel(0, 0) : texel(3, 0), kTolerance);
    EXPECT_NEAR(fetch_red(texture, 1.1F, 0, &log), wrap == Wrap::kRepeat ? texel(0, 0) : texel(3, 0), kTolerance);
    for (const float u : {-1e-8F, 0.99999994F, 1.0000001F, -7.0F, 12345.678F}) {
      EXPECT_GE(fetch_red(texture, u, u, &log), 0.0F);
      EXPECT_LT(log.back().element & 0xffffU, 4U);
      EXPECT_LT(log.back().element >> 16, 4U);
    }
  }
}

TEST(Textures, TheAccessNamesTheFootprintsCorners) {
  std::vector<traces::Access> log;
  fetch_red(ramp(Wrap::kRepeat), 0, 0.5F, &log);
  ASSERT_EQ(log.size(), 1U);
  EXPECT_EQ(log[0].kind(), traces::Access::Kind::kTexels);
  EXPECT_EQ(log[0].element, (1U << 16) | 3U);
  EXPECT_EQ(log[0].element2, (2U << 16) | 0U);
}

TEST(Decay, IsWithinItsErrorBound) {
  for (int i = 0; i <= 40000; ++i) {
    const float x = static_cast<float>(i) / 1000;
    EXPECT_NEAR(exp_negative<float>(x), std::exp(-x), 4e-6F) << x;
  }
  EXPECT_EQ(exp_negative<float>(0.0F), 1.0F);
  EXPECT_EQ(exp_negative<float>(1e30F), 0.0F);
}

TEST(Srgb, EveryCodeOfATextureDecodesToItsExactValueAndBack) {
  for (std::uint32_t code = 0; code < 256; ++code) {
    const traces::Texture texture{.name = "t", .width = 1, .height = 1, .texels = {code}};
    const float linear = fetch_red(texture, 0.5F, 0.5F);
    const double x = code / 255.0;
    EXPECT_FLOAT_EQ(linear, static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4))) << code;
    EXPECT_EQ(std::lround(255 * encode_srgb<float>(linear)), code);
  }
}

TEST(Srgb, TheEncoderIsWithinItsErrorBound) {
  EXPECT_NEAR(encode_srgb<float>(1.0F), 1.0F, 1e-6F);
  for (int i = 0; i <= 4096; ++i) {
    const float x = static_cast<float>(i) / 4096;
    EXPECT_NEAR(encode_srgb<float>(x), exactly_encoded(x), 0.2F / 255);
  }
}

}  // namespace
}  // namespace kernels
