#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "showcase.h"

namespace kernels {
namespace {

using traces::Material;
using traces::RayKind;

constexpr float kByte = 0.006F;  // largest error of rounding to 8 bits

std::uint32_t add_plain_texture(traces::Scene& scene, std::uint32_t rgba, bool srgb) {
  return add_texture(scene, 1, srgb, [&](auto, auto) { return rgba; });
}

void add_quad(traces::Scene& scene, traces::Mesh mesh, const Material& material) {
  traces::add_object(scene, std::move(mesh), traces::add_material(scene, material));
}

/// Returns the colour at the origin as seen by a camera straight in front of it.
glm::vec3 seen(const traces::Scene& scene, RenderConfig config = small(1, 1)) {
  return View(scene, {0, 0, 4}, {0, 0, 0}, config).centre();
}

traces::Mesh wall() { return traces::make_quad("wall", {-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, 1); }

constexpr std::uint32_t kTilted = 0xffe580ccU;  // the normal (0.6, 0, 0.8) in a normal map

TEST(NormalMaps, TurnTheNormalInTangentSpace) {
  const glm::vec3 light = glm::normalize(glm::vec3(1, 0.5F, 2));
  traces::Scene scene = empty_scene();
  scene.lights.push_back({.kind = traces::Light::Kind::kDirectional, .direction = -light, .intensity = glm::vec3(1)});
  const Material bumped{.base_colour = glm::vec3(1), .normal_texture = {add_plain_texture(scene, kTilted, false)}};
  const auto lit = [&](const glm::vec3& u, const glm::vec3& v, const glm::mat4& to_world = glm::mat4(1)) {
    traces::Scene s = scene;
    add_quad(s, tangent_quad(-0.5F * (u + v), u, v), bumped);
    s.instances[0].to_world = to_world;
    return seen(s).x;
  };
  EXPECT_NEAR(lit({9, 0, 0}, {0, 9, 0}), glm::dot(glm::vec3(0.6F, 0, 0.8F), light), kByte);
  EXPECT_NEAR(lit({0, 9, 0}, {-9, 0, 0}), glm::dot(glm::vec3(0, 0.6F, 0.8F), light), kByte);
  EXPECT_NEAR(lit({0, 9, 0}, {9, 0, 0}), glm::dot(glm::vec3(0, -0.6F, 0.8F), light), kByte) << "from behind";
  const glm::mat4 mirrored = glm::scale(glm::mat4(1), {-1, 1, 1});
  EXPECT_NEAR(lit({9, 0, 0}, {0, 9, 0}, mirrored), glm::dot(glm::vec3(-0.6F, 0, 0.8F), light), kByte);
}

TEST(NormalMaps, BitangentsTurnWithTheirSignAndWithAMirroredInstance) {
  traces::Scene scene = empty_scene();
  const glm::vec3 light = glm::normalize(glm::vec3(0, 1, 1));
  scene.lights.push_back({.kind = traces::Light::Kind::kDirectional, .direction = -light, .intensity = glm::vec3(1)});
  // the normal (0, 0.6, 0.8) in a normal map
  const Material bumped{.base_colour = glm::vec3(1), .normal_texture = {add_plain_texture(scene, 0xffe5cc80U, false)}};
  const auto lit = [&](float sign, float scale_x) {
    traces::Scene s = scene;
    traces::Mesh mesh = tangent_quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0});
    for (glm::vec4& t : mesh.tangents) t.w = sign;
    add_quad(s, std::move(mesh), bumped);
    s.instances[0].to_world = glm::scale(glm::mat4(1), {scale_x, 1, 1});
    return seen(s).x;
  };
  const float up = glm::dot(glm::vec3(0, 0.6F, 0.8F), light), down = glm::dot(glm::vec3(0, -0.6F, 0.8F), light);
  EXPECT_NEAR(lit(1, 1), up, kByte);
  EXPECT_NEAR(lit(-1, 1), down, kByte);
  EXPECT_NEAR(lit(1, -1), up, kByte) << "up stays up in a mirror";
  EXPECT_NEAR(lit(-1, -1), down, kByte);
}

TEST(NormalMaps, WithoutTangentsTheNormalStays) {
  traces::Scene scene = empty_scene();
  const glm::vec3 light = glm::normalize(glm::vec3(1, 0.5F, 2));
  scene.lights.push_back({.kind = traces::Light::Kind::kDirectional, .direction = -light, .intensity = glm::vec3(1)});
  add_quad(scene, wall(), {.base_colour = glm::vec3(1), .normal_texture = {add_plain_texture(scene, kTilted, false)}});
  EXPECT_NEAR(seen(scene).x, light.z, 1e-5F);
}

TEST(NormalMaps, TheNormalStaysOnTheRaysSide) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  // Tilted by 80 degrees towards +x, so that it faces away from a viewer at -x.
  add_quad(scene, tangent_quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}),
           {.mirror = 1, .normal_texture = {add_plain_texture(scene, 0xff9680feU, false)}});
  const View view(scene, {-4, 0, 2}, {0, 0, 0}, small(5, 5));
  ASSERT_EQ(view.spy.seen(RayKind::kReflection).size(), 25U);
  for (std::size_t i = 0; i < 25; ++i) {
    const glm::vec3 in = view.spy.seen(RayKind::kPrimary)[i].direction;
    const glm::vec3 out = view.spy.seen(RayKind::kReflection)[i].direction;
    EXPECT_NEAR(glm::length(out), 1, 1e-4F);
    EXPECT_LT(glm::dot(in, glm::normalize(out - in)), 0.0F) << "turned back, not through";
  }
}

/// Second implementation of the metal-roughness rule of traces/scene/gltf/materials.h, for comparison.
Material by_rule(const glm::vec3& base, float metallic, float roughness, float dielectric, float coat) {
  const float gloss = std::clamp((0.5F - roughness) / 0.4F, 0.0F, 1.0F);
  const float metal = gloss * metallic, white = gloss * (1 - metallic) * dielectric + coat;
  Material m{.base_colour = base, .mirror = std::min(metal + white, 1.0F)};
  if (m.mirror < 0.02F) m.mirror = 0;
  if (m.mirror > 0) m.mirror_tint = (metal * base + white * glm::vec3(1)) / (metal + white);
  return m;
}

TEST(MetallicRoughness, OfATextureFollowsTheRulePerTexel) {
  const glm::vec3 base(0.8F, 0.5F, 0.2F);
  for (const float metallic : {0.0F, 0.4F, 1.0F}) {
    for (const float roughness : {0.0F, 0.3F, 0.55F}) {
      for (const float coat : {0.0F, 0.05F}) {
        traces::Scene scene = empty_scene();
        scene.background = {0.9F, 0.7F, 0.3F};
        scene.ambient = glm::vec3(0.5F);
        traces::Scene expected = scene;
        add_quad(expected, wall(), by_rule(base, metallic, roughness, 0.08F, coat));
        // Half of the values come from the texture.
        const std::uint32_t texture = add_plain_texture(scene, 0xff808000U, false);
        add_quad(scene, wall(),
                 {.base_colour = base,
                  .metal_rough_texture = {texture},
                  .metallic = metallic * 255 / 128,
                  .roughness = roughness * 255 / 128,
                  .coat = coat});
        expect_near(seen(scene), seen(expected), 2e-5F);
      }
    }
  }
}

TEST(MetallicRoughness, AMetalTintsWithItsBaseTextureAndVertexColours) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  const std::uint32_t white = add_plain_texture(scene, 0xffffffffU, false);
  const std::uint32_t green = add_plain_texture(scene, 0xff00ff00U, true);
  traces::Mesh mesh = wall();
  mesh.colours.assign(4, {1, 0.5F, 1, 1});
  add_quad(scene, std::move(mesh),
           {.base_colour = {0.5F, 0.5F, 0.5F},
            .base_texture = {green},
            .metal_rough_texture = {white},
            .metallic = 1,
            .roughness = 0});
  expect_near(seen(scene), {0, 0.25F, 0}, 1e-4F);
}

TEST(Occlusion, DimsOnlyAmbientLight) {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(0.4F);
  scene.lights.push_back(
      {.kind = traces::Light::Kind::kDirectional, .direction = {0, 0, -1}, .intensity = glm::vec3(0.3F)});
  const std::uint32_t texture = add_plain_texture(scene, 0xffffff33U, false);  // 0.2
  add_quad(scene, wall(), {.base_colour = glm::vec3(1), .occlusion_texture = {texture}, .occlusion_strength = 0.5F});
  EXPECT_NEAR(seen(scene).x, 0.3F + 0.4F * 0.6F, 1e-5F);
}

TEST(Emission, IsMultipliedWithItsTexture) {
  traces::Scene scene = empty_scene();
  const std::uint32_t texture = add_plain_texture(scene, 0xff00ff80U, true);
  add_quad(scene, wall(), {.base_colour = glm::vec3(0), .emission = {1, 0.5F, 1}, .emission_texture = {texture}});
  expect_near(seen(scene), {0.2159F, 0.5F, 0}, 0.0015F);
}

TEST(VertexColours, AreInterpolatedAndMultiplyTheBaseColour) {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  traces::Mesh mesh = wall();
  for (const glm::vec3& p : mesh.positions) mesh.colours.push_back({0.1F + 0.05F * (p.x + 5), 1, 0.05F * (p.y + 5), 1});
  add_quad(scene, std::move(mesh), {.base_colour = {0.5F, 0.25F, 1}});
  const View view(scene, {0, 0, 4}, {0, 0, 0});
  for (std::uint32_t x = 0; x < 9; ++x) {
    const float at = 2 * std::tan(0.25F) * 4 / 9 * (static_cast<float>(x) - 4);
    expect_near(view.picture.at(x, 4), {0.5F * (0.35F + 0.05F * at), 0.25F, 0.25F}, 1e-4F);
  }
}

TEST(SecondTextureCoordinates, AreUsedByTexturesThatSelectThem) {
  for (const bool second : {false, true}) {
    for (const bool blended : {false, true}) {
      traces::Scene scene = empty_scene();
      scene.ambient = glm::vec3(1);
      traces::Texture texture{.name = "two", .width = 2, .height = 1, .texels = {0xff0000ffU, 0xff00ff00U}};
      texture.filter = traces::Texture::Filter::kNearest;
      scene.textures.push_back(texture);
      traces::Mesh mesh = wall();
      mesh.uvs.assign(4, {0.25F, 0.5F});
      mesh.second_uvs.assign(4, {0.75F, 0.5F});
      add_quad(scene, std::move(mesh),
               {.base_colour = glm::vec3(1),
                .base_texture = {0, second},
                .alpha = blended ? Material::Alpha::kBlend : Material::Alpha::kOpaque});
      expect_near(seen(scene), second ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), 1e-5F);
    }
  }
}

TEST(Absorption, FollowsTheExponentialOfTheDistanceInside) {
  for (const float thickness : {0.1F, 0.7F, 2.5F}) {
    traces::Scene scene = empty_scene();
    scene.background = glm::vec3(1);
    const Material body{.base_colour = glm::vec3(1), .transmission = 1, .ior = 1, .absorption = {0.5F, 1, 2}};
    add_quad(scene, wall(), body);
    add_quad(scene, traces::make_quad("back", {-5, -5, -thickness}, {0, 10, 0}, {10, 0, 0}, 1), body);
    RenderConfig config = small(1, 1);
    config.min_weight = 0;
    expect_near(seen(scene, config), {std::exp(-0.5F * thickness), std::exp(-thickness), std::exp(-2 * thickness)},
                2e-5F);
  }
}

TEST(Blending, AddsAFractionOfTheSurfaceToWhatIsBehindIt) {
  traces::Scene scene = empty_scene();
  scene.background = {1, 0, 0.5F};
  scene.ambient = glm::vec3(0.5F);
  add_quad(
      scene, wall(),
      {.base_colour = {0.2F, 0.4F, 0}, .emission = {0, 0, 0.25F}, .alpha = Material::Alpha::kBlend, .opacity = 0.25F});
  const View view(scene, {0, 0, 4}, {0, 0, 0}, small(1, 1));
  expect_near(view.centre(), 0.25F * glm::vec3(0.1F, 0.2F, 0.25F) + 0.75F * scene.background, 1e-5F);
  const auto& on = view.spy.seen(RayKind::kRefraction);
  ASSERT_EQ(on.size(), 1U);
  EXPECT_EQ(on[0].direction, view.spy.seen(RayKind::kPrimary)[0].direction);
}

TEST(Blending, AlphaIsOpacityTimesTextureTimesVertexColour) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  traces::Mesh mesh = wall();
  mesh.colours.assign(4, {1, 1, 1, 0.5F});
  const std::uint32_t half = add_plain_texture(scene, 0x80ffffffU, true);
  add_quad(scene, std::move(mesh),
           {.base_colour = glm::vec3(0), .base_texture = {half}, .alpha = Material::Alpha::kBlend, .opacity = 0.8F});
  EXPECT_NEAR(seen(scene).x, 1 - 0.8F * 0.5F * 128 / 255, 1e-4F);
}

TEST(LightRange, FadesToZeroAsTheExtensionSpecifies) {
  for (const float range : {0.0F, 1.5F, 2.5F, 100.0F}) {
    traces::Scene scene = empty_scene();
    add_quad(scene, wall(), {.base_colour = glm::vec3(1)});
    scene.lights.push_back({.position = {0, 0, 2}, .intensity = glm::vec3(2), .range = range});
    const float ratio = range > 0 ? 2 / range : 0;
    EXPECT_NEAR(seen(scene).x, 0.5F * std::clamp(1 - std::pow(ratio, 4.0F), 0.0F, 1.0F), 1e-6F);
  }
}

TEST(Details, KernelsThatASceneDoesNotNeedAreNotLaunched) {
  traces::Scene scene = traces::open_scene("cornell");
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  RenderConfig config = small(64, 32);
  config.glass_shadows = GlassShadows::kOpaque;
  const FullProgram program(image, scene.cameras[0], config, 1, 0);
  TileResult tile;
  for (std::uint32_t t = 0; t < program.tiles(); ++t) {
    program.run_tile(t, tracer, true, tile);
    EXPECT_EQ(tile.continued, 0U);
    for (const traces::WorkNode& node : tile.work.nodes) {
      if (node.kind != traces::WorkNode::Kind::kLaunch) continue;
      EXPECT_NE(node.kernel, kKernelId<ClassifyDetails>);
      EXPECT_NE(node.kernel, kKernelId<ClassifyLayers>);
    }
  }
}

}  // namespace
}  // namespace kernels
