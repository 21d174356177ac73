#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "block_harness.h"
#include "shader_kernels/catalogue.h"
#include "shader_kernels/programs/adaptive/supersample.h"
#include "shader_kernels/programs/wavefront/scene_tables.h"
#include "showcase.h"
#include "traces/accel/build/material_tables.h"

// Tests of mip levels: which ones lookups select, and how they change pictures.

namespace kernels {
namespace {

using traces::Texture;

/// Returns a texture of white and grey texels with its mip levels; level L is about 16 (L + 1) everywhere.
std::vector<Texture> numbered_levels(std::uint32_t width, std::uint32_t height) {
  std::vector<Texture> chain = traces::mip_chain(
      {.name = "t", .width = width, .height = height, .texels = std::vector<std::uint32_t>(width * height)});
  for (std::size_t level = 0; level < chain.size(); ++level) {
    for (std::uint32_t& texel : chain[level].texels) texel = static_cast<std::uint32_t>(16 * (level + 1));
  }
  return chain;
}

/// Looks up a texture of `width` x `height` for the footprint in texture coordinates, and returns the sRGB code.
template <MipFilter kMips>
float look_up(std::uint32_t width, std::uint32_t height, float footprint, std::vector<traces::Access>* log = nullptr) {
  const std::vector<Texture> chain = numbered_levels(width, height);
  std::vector<AxisRecord<float>> axes;
  for (const Texture& level : chain) {
    axes.push_back(axis_record(level.width, level.wrap_u, level.filter));
    axes.push_back(axis_record(level.height, level.wrap_v, level.filter));
  }
  const LevelRecord<float> levels[] = {level_record(chain[0], static_cast<std::uint32_t>(chain.size()), kMips)};
  std::uint32_t stream[] = {0};
  TexcoordRecord<float> texcoords[] = {{0.3F, 0.6F, pack_footprint<float>(0, footprint)}};
  DiffuseRecord<float> mattes[] = {{{1, 1, 1}, 7}};
  typename ShadeTextured<kMips>::template Ports<float> ports;
  ports.textured.bind(stream);
  ports.texcoords.bind(texcoords);
  ports.mattes.bind(mattes);
  ports.axes.bind(axes.data());
  ports.levels.bind(levels);
  ports.texels.bind_raw(chain.data(), log);
  const std::vector<SrgbCodeRecord<float>> codes = srgb_code_records();
  ports.srgb_codes.bind(codes.data());
  ShadeTextured<kMips>::template body<float>(0, ports);
  return mattes[0].diffuse.x;
}
float level(std::uint32_t number) { return srgb_code_records()[16 * (number + 1)].linear; }

TEST(NearestMipLevel, HasTheTexelSizeNearestToTheFootprint) {
  constexpr auto kNearest = MipFilter::kNearest;
  for (const float texels : {0.0F, 0.01F, 1.0F, 1.4F})
    EXPECT_FLOAT_EQ(look_up<kNearest>(16, 16, texels / 16), level(0));
  for (const float texels : {1.43F, 2.0F, 2.8F}) EXPECT_FLOAT_EQ(look_up<kNearest>(16, 16, texels / 16), level(1));
  for (const float texels : {2.86F, 4.0F}) EXPECT_FLOAT_EQ(look_up<kNearest>(16, 16, texels / 16), level(2));
  for (const float texels : {16.0F, 1e9F}) EXPECT_FLOAT_EQ(look_up<kNearest>(16, 16, texels / 16), level(4));
  for (const float footprint : {0.0F, 1e-9F, 1.0F, 1e9F}) EXPECT_FLOAT_EQ(look_up<kNearest>(1, 1, footprint), level(0));
}

TEST(NearestMipLevel, OfALongTextureFollowsItsAreaAndEndsAtItsLongSide) {
  constexpr auto kNearest = MipFilter::kNearest;
  EXPECT_FLOAT_EQ(look_up<kNearest>(64, 4, 2.0F / 16), level(1)) << "as 16 x 16";
  EXPECT_FLOAT_EQ(look_up<kNearest>(64, 4, 1e9F), level(6));
}

TEST(Trilinear, BlendsTheTwoLevelsAboutTheFootprint) {
  constexpr auto kLinear = MipFilter::kLinear;
  for (const float texels : {0.0F, 0.5F, 1.0F}) EXPECT_FLOAT_EQ(look_up<kLinear>(16, 16, texels / 16), level(0));
  EXPECT_NEAR(look_up<kLinear>(16, 16, 1.25F / 16), 0.75F * level(0) + 0.25F * level(1), 1e-6F);
  EXPECT_NEAR(look_up<kLinear>(16, 16, 6.0F / 16), 0.5F * level(2) + 0.5F * level(3), 1e-6F);
  for (const float texels : {16.0F, 1e9F}) EXPECT_FLOAT_EQ(look_up<kLinear>(16, 16, texels / 16), level(4));
}

TEST(MipAccesses, NameTheLevelAndAWholeOneTwice) {
  std::vector<traces::Access> log;
  look_up<MipFilter::kNearest>(16, 16, 4.0F / 16, &log);
  ASSERT_EQ(log.size(), 1U);
  EXPECT_EQ(log[0].texture(), 2U);
  EXPECT_EQ(log[0].element, (1U << 16) | 0U) << "texel (0.7, 1.9) of 4 x 4";
  log.clear();
  look_up<MipFilter::kLinear>(16, 16, 6.0F / 16, &log);
  ASSERT_EQ(log.size(), 2U);
  EXPECT_EQ(log[0].texture(), 2U);
  EXPECT_EQ(log[1].texture(), 3U);
  log.clear();
  look_up<MipFilter::kLinear>(16, 16, 4.0F / 16, &log);
  EXPECT_EQ(log[0].texture(), log[1].texture()) << "nothing is fetched of a level that has no weight";
  EXPECT_EQ(log[0].element, log[1].element);
}

/// Returns a wall in z = 0 with a texture of 512 x 512 per unit, chequered by texel, in ambient light.
traces::Scene chequered_wall() {
  traces::Scene scene = empty_scene();
  Texture chequers{.name = "chequers", .width = 512, .height = 512};
  for (std::uint32_t i = 0; i < 512 * 512; ++i) chequers.texels.push_back((i + i / 512) % 2 == 0 ? ~0U : 0xff000000U);
  scene.textures.push_back(chequers);
  scene.ambient = glm::vec3(1);
  traces::Mesh wall = traces::make_quad("wall", {-50, -50, 0}, {100, 0, 0}, {0, 100, 0}, 1);
  for (std::size_t i = 0; i < 4; ++i) wall.uvs[i] = {wall.positions[i].x, wall.positions[i].y};
  traces::add_object(scene, wall,
                     traces::add_material(scene, {.name = "m", .base_colour = glm::vec3(1), .base_texture = {0}}));
  return scene;
}

/// Returns the levels that a picture of `scene` reads. A pixel's height is 1/256 at distance 1.
std::vector<std::uint32_t> levels_seen(const traces::Scene& scene, const glm::vec3& eye, const glm::vec3& target,
                                       std::uint32_t samples, const traces::BvhConfig& bvh = {}) {
  const traces::MemoryImage image = traces::build_memory_image(scene, bvh, 1, nullptr, traces::MipMaps::kOn);
  const traces::BvhTracer tracer(image);
  const traces::Camera camera = traces::look_at("view", eye, target, 2 * std::atan(1.0F / 256));
  FullProgram program(image, camera, small(2, 2), samples, 0);
  TileResult tile;
  program.run_tile(0, tracer, true, tile);
  std::vector<std::uint32_t> seen;
  for (const traces::Access& access : tile.work.accesses) {
    if (access.kind() == traces::Access::Kind::kTexels) seen.push_back(access.texture());
  }
  std::ranges::sort(seen);
  seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
  return seen;
}

using Levels = std::vector<std::uint32_t>;

/// The texture has 512 texels per unit, so a pixel covers 2 texels per unit of distance.
TEST(RayCones, GrowWithTheDistance) {
  const traces::Scene scene = chequered_wall();
  EXPECT_EQ(levels_seen(scene, {0, 0, 0.25F}, {0, 0, 0}, 1), Levels{0});
  EXPECT_EQ(levels_seen(scene, {0, 0, 1}, {0, 0, 0}, 1), Levels{1});
  EXPECT_EQ(levels_seen(scene, {0, 0, 8}, {0, 0, 0}, 1), Levels{4});
  EXPECT_EQ(levels_seen(scene, {0, 0, 10000}, {0, 0, 0}, 1), Levels{9});
}

TEST(RayCones, AreAsWideAsTheirSamples) {
  EXPECT_EQ(levels_seen(chequered_wall(), {0, 0, 8}, {0, 0, 0}, 4), Levels{3});
  EXPECT_EQ(levels_seen(chequered_wall(), {0, 0, 8}, {0, 0, 0}, 16), Levels{2});
}

TEST(RayCones, CoverMoreOfASurfaceAtAnAngle) {
  const float sine = std::sin(std::numbers::pi_v<float> / 3);
  EXPECT_EQ(levels_seen(chequered_wall(), {8 * sine, 0, 4}, {0, 0, 0}, 1), Levels{5})
      << "60 degrees off: twice as long";
}

TEST(RayCones, KeepGrowingAfterAMirror) {
  traces::Scene scene = chequered_wall();
  const traces::Scene wall = scene;
  traces::add_object(scene, traces::make_quad("mirror", {-1, -1, 4}, {0, 2, 0}, {2, 0, 0}, 1),
                     traces::add_material(scene, {.name = "mirror", .mirror = 1}));
  EXPECT_EQ(levels_seen(scene, {0, 0, 0.001F}, {0, 0, 4}, 1), Levels{4}) << "4 there and 4 back";
  EXPECT_EQ(levels_seen(wall, {0, 0, 4}, {0, 0, 0}, 1), Levels{3});
}

/// An instance four times as large has a quarter of the texture density.
TEST(RayCones, FollowAnInstancesScale) {
  traces::Scene scene = chequered_wall();
  scene.instances[0].to_world = glm::scale(glm::mat4(1), glm::vec3(4));
  const Levels flat = levels_seen(scene, {0, 0, 8}, {0, 0, 0}, 1);
  EXPECT_EQ(flat, Levels{2});
  EXPECT_EQ(levels_seen(scene, {0, 0, 8}, {0, 0, 0}, 1, {.instances = traces::InstanceLevels::kTwoLevel}), flat);
}

/// Texel density is the root of a ratio of areas. A scale along the normal does not change it; a scale of 4 along one
/// axis of the surface halves it.
TEST(RayCones, FollowScalesThatDifferByAxis) {
  const traces::Scene wall = chequered_wall();
  const auto levels = [&](const glm::vec3& scale, float degrees, traces::InstanceLevels instances) {
    traces::Scene scene = wall;
    scene.instances[0].to_world =
        glm::scale(glm::rotate(glm::mat4(1), glm::radians(degrees), glm::vec3(0, 0, 1)), scale);
    return levels_seen(scene, {0, 0, 8}, {0, 0, 0}, 1, {.instances = instances});
  };
  for (const auto instances : {traces::InstanceLevels::kFlatten, traces::InstanceLevels::kTwoLevel}) {
    EXPECT_EQ(levels({1, 1, 0.074F}, 0, instances), Levels{4});
    EXPECT_EQ(levels({1, 1, 20}, 30, instances), Levels{4});
    EXPECT_EQ(levels({4, 1, 1}, 0, instances), Levels{3});
    EXPECT_EQ(levels({-16, 1, 0.5F}, 60, instances), Levels{2});
    EXPECT_EQ(levels({0.25F, 0.25F, 3}, 0, instances), Levels{6});
  }
}

TEST(MipMapped, PicturesOfFineTexturesAreFreeOfAliases) {
  const traces::Scene scene = chequered_wall();
  const traces::Camera camera = traces::look_at("view", {0.1F, 0.2F, 20}, {0.3F, 0, 0}, 0.5F);
  const auto error = [&](traces::MipMaps mip_maps, MipBlend blend) {
    const traces::MemoryImage image = traces::build_memory_image(scene, {}, 1, nullptr, mip_maps);
    const traces::BvhTracer tracer(image);
    RenderConfig config = small(32, 32);
    config.mip_filter = blend;
    double sum = 0;
    for (const float x : render(image, camera, tracer, config).rgb) sum += std::abs(x - 0.5F);
    return sum / (3 * 32 * 32);
  };
  EXPECT_GT(error(traces::MipMaps::kOff, MipBlend::kNearest), 0.1);
  EXPECT_LT(error(traces::MipMaps::kOn, MipBlend::kNearest), 0.005);
  EXPECT_LT(error(traces::MipMaps::kOn, MipBlend::kLinear), 0.005);
}

/// An image without levels is rendered by kernels without mip maps, whatever the configuration.
TEST(MipMapped, ImagesWithoutLevelsAreRenderedAsTheyAre) {
  const Stage stage(showcase_scene());
  const auto kernels_of = [&](const RenderConfig& config) {
    std::vector<traces::KernelId> kernels;
    FullProgram program(stage.image, stage.camera, config, 1, 0);
    TileResult tile;
    program.run_tile(0, stage.tracer, true, tile);
    for (const traces::WorkNode& node : tile.work.nodes) kernels.push_back(node.kernel);
    return kernels;
  };
  RenderConfig on = small(32, 32), off = on;
  off.mip_maps = traces::MipMaps::kOff;
  on.mip_filter = MipBlend::kLinear;
  EXPECT_EQ(kernels_of(on), kernels_of(off));
  EXPECT_EQ(stage.full(on).rgb, stage.full(off).rgb);
}

class MipMappedPrograms : public testing::TestWithParam<MipBlend> {
 protected:
  MipMappedPrograms() { render_.mip_filter = GetParam(); }
  Stage stage_{showcase_scene(), traces::MipMaps::kOn};
  RenderConfig render_ = small(37, 23);
};
INSTANTIATE_TEST_SUITE_P(Filters, MipMappedPrograms, testing::Values(MipBlend::kNearest, MipBlend::kLinear),
                         [](const auto& i) {
                           return std::string(names_of(i.param)[static_cast<std::size_t>(i.param)]);
                         });

TEST_P(MipMappedPrograms, LookUpOtherTexelsThanWithoutMipMaps) {
  EXPECT_NE(stage_.full(render_).rgb, Stage(showcase_scene()).full(render_).rgb);
}

TEST_P(MipMappedPrograms, FusionChangesNoPicture) {
  RenderConfig apart = render_;
  apart.fusion = Fusion::kOff;
  EXPECT_EQ(stage_.full(render_).rgb, stage_.full(apart).rgb);
}

TEST_P(MipMappedPrograms, MultirateThatFindsNothingSimilarIsFull) {
  MultirateConfig config;
  config.normal = 2;
  for (const std::uint32_t grid : {1U, 2U}) {
    EXPECT_EQ(stage_.multirate(render_, config, grid).rgb, stage_.full(render_, grid * grid).rgb);
  }
}

TEST_P(MipMappedPrograms, UndersampleThatFindsNothingSimilarIsFull) {
  UndersampleConfig config;
  config.normal = 2;
  for (const std::uint32_t samples : {1U, 4U}) {
    config.samples = samples;
    EXPECT_EQ(stage_.undersample(render_, config).rgb, stage_.full(render_, samples).rgb);
  }
}

TEST_P(MipMappedPrograms, SupersampleThatTakesEverySubpixelIsFull) {
  SupersampleConfig config;
  config.colour = config.object = config.normal = config.shadow = config.texture = 0;
  RenderConfig jittered = render_;
  jittered.samples = SamplePattern::kJittered;
  SupersampleProgram program(stage_.image, stage_.camera, jittered, config, 0);
  EXPECT_EQ(run_program(program, stage_.tracer).rgb, stage_.full(jittered, 16).rgb);
}

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
