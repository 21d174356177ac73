#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "shader_kernels/programs/path_program.h"
#include "shader_kernels/programs/programs.h"
#include "sim/error.h"
#include "tests/shader_kernels/harness.h"
#include "tests/shader_kernels/path/reference_paths.h"
#include "tests/shader_kernels/showcase.h"

namespace kernels {
namespace {

using traces::RayKind;
using traces::Roughness;

constexpr std::size_t index_of(RayKind kind) { return static_cast<std::size_t>(kind); }

/// Returns a configuration for paths of `rays` rays, with jittered samples.
RenderConfig path_config(std::uint32_t width, std::uint32_t height, std::uint32_t rays) {
  RenderConfig config = small(width, height);
  config.depth = rays;
  config.samples = SamplePattern::kJittered;
  config.glass_shadows = GlassShadows::kOpaque;
  return config;
}

/// Paths of a scene, with the sums of the unclamped samples of each pixel.
struct PathView {
  PathView(const traces::Scene& scene, const traces::Camera& eye, const RenderConfig& render, std::uint32_t samples,
           const PathConfig& path = {}, Roughness roughness = Roughness::kOff)
      : image(traces::build_memory_image(scene, {}, 1, nullptr, traces::MipMaps::kOff, roughness)),
        tracer(image),
        pixels(std::size_t{render.width} * render.height) {
    PathProgram program(image, eye, render, path, samples, 0);
    run_tiles(program, tracer, false, [&](const TileResult& tile) {
      for (std::size_t k = 0; k < rays.size(); ++k) rays[k] += tile.rays[k];
      for (std::uint32_t i = 0; i < tile.work.samples; ++i) {
        const std::uint32_t pixel = i / samples, x = tile.x + pixel % tile.width, y = tile.y + pixel / tile.width;
        const auto& [red, green, blue] = tile.buffer.samples.colours[i].rgb;
        lowest = std::min({lowest, red, green, blue});
        highest = std::max({highest, red, green, blue});
        pixels[std::size_t{y} * render.width + x].add(glm::dvec3(red, green, blue));
      }
    });
    rgb = program.picture();
    for (const PixelSums& pixel : pixels) mean += pixel.sum / (samples * static_cast<double>(pixels.size()));
  }

  const traces::MemoryImage image;
  const traces::BvhTracer tracer;
  std::vector<PixelSums> pixels;
  std::vector<float> rgb;
  std::array<std::uint64_t, static_cast<std::size_t>(RayKind::kCount)> rays{};
  float lowest = 1e9F, highest = 0;  ///< smallest and largest channel of all samples
  glm::dvec3 mean{0};
};

/// Standard deviations by which two estimates of blocks of pixels differ.
struct Deviations {
  double most = 0, root_mean_square = 0;
};
Deviations compare_blocks(const std::vector<PixelSums>& a, const std::vector<PixelSums>& b, std::uint32_t width,
                          std::uint32_t block) {
  const auto height = static_cast<std::uint32_t>(a.size()) / width;
  const auto estimate = [&](const std::vector<PixelSums>& pixels, std::uint32_t x0, std::uint32_t y0, int channel) {
    double mean = 0, variance = 0;
    for (std::uint32_t y = y0; y < y0 + block; ++y) {
      for (std::uint32_t x = x0; x < x0 + block; ++x) {
        const PixelSums& p = pixels[std::size_t{y} * width + x];
        const double n = p.samples, m = p.sum[channel] / n;
        mean += m;
        variance += std::max(p.squares[channel] / n - m * m, 0.0) / (n - 1);
      }
    }
    return std::pair{mean, variance};
  };
  Deviations result;
  double squares = 0, count = 0;
  for (std::uint32_t y = 0; y + block <= height; y += block) {
    for (std::uint32_t x = 0; x + block <= width; x += block) {
      for (int channel = 0; channel < 3; ++channel) {
        const auto [mean_a, variance_a] = estimate(a, x, y, channel);
        const auto [mean_b, variance_b] = estimate(b, x, y, channel);
        constexpr double kRounding = 1e-9;
        const double z = (mean_a - mean_b) / std::sqrt(variance_a + variance_b + kRounding);
        result.most = std::max(result.most, std::abs(z));
        squares += z * z;
        count += 1;
      }
    }
  }
  result.root_mean_square = std::sqrt(squares / count);
  return result;
}

/// Returns a closed box with a camera inside; its faces look inward and have one material.
traces::Scene closed_box(const traces::Material& material) {
  traces::Scene scene = empty_scene();
  const std::uint32_t m = traces::add_material(scene, material);
  const auto face = [&](const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    traces::add_object(scene, traces::make_quad("face", corner, u, v, 1), m);
  };
  const glm::vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2);
  face({-1, -1, -1}, x, y);
  face({-1, -1, 1}, y, x);
  face({-1, -1, -1}, y, z);
  face({1, -1, -1}, z, y);
  face({-1, -1, -1}, z, x);
  face({-1, 1, -1}, x, z);
  scene.cameras = {traces::look_at("inside", {0.1F, 0.2F, 0.3F}, {0.5F, 0.4F, -1}, 1.2F)};
  return scene;
}

/// Returns a wall that fills the picture, under an environment of radiance 1.
traces::Scene wall_under_white_sky(const traces::Material& material) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  add_wall(scene, 0, 1000, material);
  scene.cameras = {traces::look_at("eye", {0, 0, 2}, {0, 0, 0}, 0.5F)};
  return scene;
}

traces::Material rough_metal(float roughness, const glm::vec3& reflectance = glm::vec3(1)) {
  return {.name = "metal",
          .base_colour = reflectance,
          .mirror = 1,
          .metallic = 1,
          .roughness = roughness,
          .dielectric = 0,
          .facet_mirror = reflectance};
}

TEST(PathProgramName, HasASquareNumberOfSamples) {
  EXPECT_EQ(parse_program("path:16").name(), "path:16");
  EXPECT_EQ(parse_program("path:1").kind, ProgramSpec::Kind::kPath);
  for (const char* text : {"path", "path:", "path:2", "path:x", "paths:1"}) {
    EXPECT_THROW(parse_program(text), sim::InputError) << text;
  }
}

TEST(PathProgramEffects, AreAllOfAPathTracer) {
  const traces::Scene scene = wall_under_white_sky({});
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const ProgramConfig programs;
  const RateMap rates(programs.multirate);
  for (const char* effects : {"none", "shadows", "shadows, reflections, refractions, occlusion"}) {
    RenderConfig config = small(8, 8);
    config.effects = effects;
    EXPECT_THROW(make_program(parse_program("path:1"), {image, scene.cameras.front(), config, programs, rates}),
                 sim::InputError)
        << effects;
  }
}

TEST(Furnace, EverySampleOfAWallUnderAWhiteSkyIsItsAlbedo) {
  const glm::vec3 albedo(0.75F, 0.5F, 0.125F);
  const traces::Scene scene = wall_under_white_sky({.name = "matte", .base_colour = albedo});
  const PathView view(scene, scene.cameras.front(), path_config(16, 16, 2), 4);
  for (const PixelSums& pixel : view.pixels) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel.sum[c] / 4, static_cast<double>(albedo[c]), 1e-6);
  }
}

TEST(Furnace, AClosedEmissiveBoxSumsAGeometricSeries) {
  constexpr float kEmission = 0.1F, kAlbedo = 0.7F;
  const traces::Scene scene =
      closed_box({.name = "glow", .base_colour = glm::vec3(kAlbedo), .emission = glm::vec3(kEmission)});
  for (const std::uint32_t rays : {1U, 2U, 5U}) {
    const PathView view(scene, scene.cameras.front(), path_config(8, 8, rays), 4, {.roulette_start = 16});
    const float expected = kEmission * (1 - std::pow(kAlbedo, static_cast<float>(rays))) / (1 - kAlbedo);
    EXPECT_NEAR(view.lowest, expected, 1e-6F) << rays;
    EXPECT_NEAR(view.highest, expected, 1e-6F) << rays;
  }
}

TEST(Furnace, RouletteKeepsTheMean) {
  const traces::Scene scene =
      closed_box({.name = "glow", .base_colour = glm::vec3(0.5F), .emission = glm::vec3(0.25F)});
  const PathView view(scene, scene.cameras.front(), path_config(32, 32, 8), 16, {.roulette_start = 1});
  const double expected = 0.25 * (1 - std::pow(0.5, 8)) / 0.5;
  EXPECT_NEAR(view.mean.x, expected, 0.015 * expected);
  EXPECT_LT(view.lowest, 0.3F);
  const std::uint64_t without = 32 * 32 * 16 * 7;
  EXPECT_LT(view.rays[index_of(RayKind::kReflection)], without / 3);
}

TEST(Furnace, RoughMetalNeverReflectsMoreThanItGetsAndLosesLightWithRoughness) {
  double before = 1.0001;
  for (const float roughness : {0.2F, 0.6F, 1.0F}) {
    const traces::Scene scene = wall_under_white_sky(rough_metal(roughness));
    const PathView view(scene, scene.cameras.front(), path_config(24, 24, 2), 4, {}, Roughness::kOn);
    EXPECT_LE(view.highest, 1.00001F);
    EXPECT_LT(view.mean.x, before) << roughness;
    before = view.mean.x;
  }
}

TEST(Furnace, OfTheRoughestMetalSeenFromAboveHasAClosedForm) {
  // With alpha 1 facets are cosine-distributed, and the mean of G2 / G1 is the integral of c / (1 + c) from 0 to 1.
  const traces::Scene scene = wall_under_white_sky(rough_metal(1));
  const PathView view(scene, traces::look_at("above", {0, 0, 2}, {0, 0, 0}, 0.02F), path_config(24, 24, 2), 16, {},
                      Roughness::kOn);
  EXPECT_NEAR(view.mean.x, 1 - std::numbers::ln2, 0.012);
}

TEST(PathRays, AreAtMostOneAndAShadowRayForEachPathAndBounce) {
  const traces::Scene scene = traces::open_scene("cornell");
  const PathView view(scene, scene.cameras.front(), path_config(32, 16, 4), 4);
  const std::uint64_t paths = 32 * 16 * 4;
  EXPECT_EQ(view.rays[index_of(RayKind::kPrimary)], paths);
  const std::uint64_t extensions =
      view.rays[index_of(RayKind::kReflection)] + view.rays[index_of(RayKind::kRefraction)];
  EXPECT_LE(extensions, 3 * paths);
  EXPECT_GT(extensions, paths);
  EXPECT_LE(view.rays[index_of(RayKind::kShadow)], 4 * paths);
  EXPECT_GT(view.rays[index_of(RayKind::kShadow)], paths);
}

TEST(PathPicture, DoesNotDependOnTilesStreamsOrFusion) {
  const traces::Scene scene = traces::open_scene("cornell");
  RenderConfig config = path_config(40, 24, 4);
  config.effects = "soft_shadows, reflections, refractions";
  config.glass_shadows = GlassShadows::kTinted;
  const std::vector<float> picture = PathView(scene, scene.cameras.front(), config, 4).rgb;
  config.tile = 7;
  EXPECT_EQ(PathView(scene, scene.cameras.front(), config, 4).rgb, picture);
  config.streams = Streams::kDivergent;
  config.fusion = Fusion::kOff;
  EXPECT_EQ(PathView(scene, scene.cameras.front(), config, 4).rgb, picture);
}

TEST(PathPicture, ChangesWithTheFrameNumber) {
  const traces::Scene scene = traces::open_scene("cornell");
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  const RenderConfig config = path_config(16, 8, 3);
  const auto picture = [&](std::uint32_t frame) {
    PathProgram program(image, scene.cameras.front(), config, {}, 1, frame);
    run_tiles(program, tracer, true, [](const TileResult&) {});
    return program.picture();
  };
  EXPECT_EQ(picture(1), picture(1));
  EXPECT_NE(picture(1), picture(2));
}

/// Paths between a floor and a lamp, with two panes and a light source between them. The lower half of the picture
/// shows the floor, and the upper half shows the lamp through the panes.
PathView view_lamp_through_panes(const traces::Material& pane, GlassShadows shadows, float emission) {
  traces::Scene scene = empty_scene();
  const auto add_plane = [&](float y, const traces::Material& material) {
    traces::add_object(scene, traces::make_quad("plane", {-50, y, 50}, {100, 0, 0}, {0, 0, -100}, 1),
                       traces::add_material(scene, material));
  };
  add_plane(0, {.name = "floor"});
  add_plane(2, pane);
  add_plane(3, pane);
  add_plane(4, {.name = "lamp", .emission = glm::vec3(emission)});
  scene.lights.push_back({.position = {0, 3.5F, -4}, .intensity = glm::vec3(20)});
  RenderConfig config = path_config(16, 8, 4);
  config.glass_shadows = shadows;
  return {scene, traces::look_at("eye", {0, 1, 0}, {0, 1, -1}, 1.5F), config, 64, {.roulette_start = 16}};
}

/// Mean light that the lamp's emission adds to pixels of the floor and of the lamp. Rows at the horizon are left out.
struct AddedLight {
  double floor = 0, lamp = 0;
  AddedLight(const traces::Material& pane, GlassShadows shadows) {
    constexpr float kEmission = 0.9F;
    const PathView dark = view_lamp_through_panes(pane, shadows, 0),
                   lit = view_lamp_through_panes(pane, shadows, kEmission);
    for (std::size_t i = 0; i < 3 * 16; ++i) {
      lamp += (lit.pixels[i].sum.x - dark.pixels[i].sum.x) / (64 * 3 * 16);
      floor += (lit.pixels[5 * 16 + i].sum.x - dark.pixels[5 * 16 + i].sum.x) / (64 * 3 * 16);
    }
  }
};

TEST(PathEmission, CountsLampsOnceWhereShadowRaysPassGlass) {
  const traces::Material glass{.name = "glass", .base_colour = glm::vec3(0.8F), .transmission = 1, .ior = 1};
  const AddedLight tinted(glass, GlassShadows::kTinted), opaque(glass, GlassShadows::kOpaque);
  EXPECT_NEAR(tinted.floor, 0, 1e-6);
  EXPECT_GT(opaque.floor, 0.1);
  // The mean of 0.9 (0.8 (1 - (1 - cosine)^5))^2 over these pixels: glass mirrors at grazing angles.
  EXPECT_NEAR(tinted.lamp, 0.441, 0.01);
  EXPECT_NEAR(opaque.lamp, tinted.lamp, 1e-6);
}

TEST(PathEmission, CountsLampsOnceThroughBlendedSurfaces) {
  const traces::Material cloth{
      .name = "cloth", .base_colour = glm::vec3(0.5F), .alpha = traces::Material::Alpha::kBlend, .opacity = 0.5F};
  for (const GlassShadows shadows : {GlassShadows::kTinted, GlassShadows::kOpaque}) {
    const AddedLight added(cloth, shadows);
    EXPECT_NEAR(added.floor, 0, 1e-6);
    EXPECT_NEAR(added.lamp, 0.9 * 0.5 * 0.5, 0.03);
  }
}

class PathMean : public testing::TestWithParam<const char*> {};

TEST_P(PathMean, IsThatOfAPathTracerWithEmbree) {
  const traces::Scene scene = traces::open_scene(GetParam());
  const RenderConfig config = path_config(16, 8, 4);
  const PathView view(scene, scene.cameras.front(), config, 256);
  ReferencePaths reference(view.image, scene.cameras.front(), config, PathConfig{});
  const Deviations z = compare_blocks(view.pixels, reference.render(256, 7), 16, 4);
  EXPECT_LT(z.most, 4);
  EXPECT_LT(z.root_mean_square, 1.5);
  EXPECT_GT(view.mean.x, 0.01);
}
INSTANTIATE_TEST_SUITE_P(Scenes, PathMean,
                         testing::Values("cornell", "teapot", "car", "chess", "atrium", "laboratory"));

TEST(PathMean, OfRoughSurfacesIsThatOfAPathTracerWithEmbree) {
  for (const float roughness : {0.15F, 0.5F, 1.0F}) {
    traces::Scene scene = wall_under_white_sky(rough_metal(roughness, {0.9F, 0.6F, 0.3F}));
    add_wall(scene, -1, 1, {});
    const std::uint32_t plastic = traces::add_material(scene, {.name = "plastic",
                                                               .base_colour = {0.2F, 0.4F, 0.8F},
                                                               .roughness = roughness,
                                                               .facet_mirror = glm::vec3(0.04F)});
    traces::add_object(scene, traces::make_quad("side", {-0.6F, -500, -1}, {0, 0, 500}, {0, 1000, 0}, 1), plastic);
    scene.lights.push_back({.position = {0.5F, 1, 2}, .intensity = glm::vec3(2)});
    const RenderConfig config = path_config(16, 8, 3);
    const PathView view(scene, scene.cameras.front(), config, 256, {}, Roughness::kOn);
    ReferencePaths reference(view.image, scene.cameras.front(), config, PathConfig{});
    const Deviations z = compare_blocks(view.pixels, reference.render(256, 7), 16, 4);
    EXPECT_LT(z.most, 4) << roughness;
    EXPECT_LT(z.root_mean_square, 1.5) << roughness;
  }
}

TEST(RoughMaterials, HaveRoughnessOnlyInImagesBuiltForIt) {
  const traces::Scene scene = wall_under_white_sky(rough_metal(0.4F, {0.9F, 0.6F, 0.3F}));
  const auto flags = [&](Roughness roughness) {
    return traces::build_memory_image(scene, {}, 1, nullptr, traces::MipMaps::kOff, roughness).materials[0].flags;
  };
  EXPECT_EQ(flags(Roughness::kOn) >> traces::kRoughnessShift, 102U);
  EXPECT_EQ(flags(Roughness::kOff) >> traces::kRoughnessShift, 0U);
}

TEST(RoughMaterials, WithAWhiteTextureAreThoseOfTheFactors) {
  traces::Material metal = rough_metal(0.4F, {0.9F, 0.6F, 0.3F});
  const auto samples = [&](const traces::Scene& scene) {
    const PathView view(scene, scene.cameras.front(), path_config(8, 8, 2), 4, {}, Roughness::kOn);
    return view.rgb;
  };
  const std::vector<float> plain = samples(wall_under_white_sky(metal));
  traces::Scene scene = wall_under_white_sky(metal);
  scene.materials[0].metal_rough_texture = {add_texture(scene, 1, false, [](auto, auto) { return 0xffffffffU; })};
  const std::vector<float> textured = samples(scene);
  for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_NEAR(textured[i], plain[i], 1e-5F);
}

TEST(RoughReflections, OfWhittedFramesLeaveSmoothScenesUnchanged) {
  const traces::Scene scene = traces::open_scene("cornell");
  const auto picture = [&](Roughness roughness) {
    const traces::MemoryImage image =
        traces::build_memory_image(scene, {}, 1, nullptr, traces::MipMaps::kOff, roughness);
    return render(image, scene.cameras.front(), traces::BvhTracer(image), small(48, 24)).rgb;
  };
  EXPECT_EQ(picture(Roughness::kOff), picture(Roughness::kOn));
}

TEST(RoughReflections, OfWhittedFramesSpreadWithRoughness) {
  const auto spread = [](float roughness) {
    traces::Scene scene = wall_under_white_sky(rough_metal(roughness));
    const traces::MemoryImage image =
        traces::build_memory_image(scene, {}, 1, nullptr, traces::MipMaps::kOff, Roughness::kOn);
    const traces::BvhTracer tracer(image);
    const SpyTracer spy(tracer);
    const Picture picture = render(image, scene.cameras.front(), spy, small(24, 24));
    for (const float x : picture.rgb) EXPECT_LE(x, 1);
    double sum = 0;
    for (const traces::Ray& ray : spy.seen(RayKind::kReflection)) sum += static_cast<double>(ray.direction.z);
    return 1 - sum / static_cast<double>(spy.seen(RayKind::kReflection).size());
  };
  EXPECT_LT(spread(0), 0.04);
  EXPECT_GT(spread(0.4F), 0.04);
  EXPECT_GT(spread(0.8F), 2 * spread(0.4F));
}

}  // namespace
}  // namespace kernels
