#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "harness.h"

namespace kernels {
namespace {

using traces::RayKind;

TEST(Shading, PointLightOnAWallIsAlbedoTimesIrradiance) {
  traces::Scene scene = empty_scene();
  const glm::vec3 albedo(0.8F, 0.4F, 0.2F), intensity(2, 3, 4), light(0.5F, 0.25F, 2);
  add_wall(scene, 0, 10, {.name = "matte", .base_colour = albedo});
  scene.lights.push_back({.position = light, .intensity = intensity});
  const View view(scene, {0, 0, 4}, {0, 0, 0});
  for (std::uint32_t y = 0; y < 9; ++y) {
    for (std::uint32_t x = 0; x < 9; ++x) {
      const float pixel = 2 * std::tan(0.25F) * 4 / 9;
      const glm::vec3 at((static_cast<float>(x) - 4) * pixel, (4 - static_cast<float>(y)) * pixel, 0);
      const glm::vec3 to_light = light - at;
      const float squared = glm::dot(to_light, to_light);
      const float cosine = to_light.z / std::sqrt(squared);
      expect_near(view.picture.at(x, y), albedo * intensity * cosine / squared, 1e-5F);
    }
  }
  EXPECT_EQ(view.picture.rays[static_cast<std::size_t>(RayKind::kShadow)], 81U);
}

TEST(Shading, DirectionalLightHasNoFalloffAndAmbientAndEmissionAreAddedOnce) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.name = "matte", .base_colour = glm::vec3(0.5F), .emission = {0.125F, 0, 0}});
  const glm::vec3 direction = glm::normalize(glm::vec3(0, -1, -1));
  for (int i = 0; i < 2; ++i) {
    scene.lights.push_back(
        {.kind = traces::Light::Kind::kDirectional, .direction = direction, .intensity = glm::vec3(0.25F)});
  }
  scene.ambient = glm::vec3(0.25F, 0.5F, 0.75F);
  const View view(scene, {0, 0, 4}, {0, 0, 0});
  const float lit = 2 * 0.5F * 0.25F * std::numbers::sqrt2_v<float> / 2;
  expect_near(view.centre(), glm::vec3(0.125F + 0.125F, 0.25F, 0.375F) + lit, 1e-6F);
}

TEST(Shading, SpotFallsOffBetweenItsCones) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.name = "matte", .base_colour = glm::vec3(1)});
  const float angle = std::atan2(1.0F, 2.0F);  // direction from the light to the picture's centre
  const auto with_cone = [&](float inner, float outer) {
    scene.lights = {{.kind = traces::Light::Kind::kSpot,
                     .position = {1, 0, 2},
                     .direction = {0, 0, -1},
                     .intensity = glm::vec3(2),
                     .cos_inner = std::cos(inner),
                     .cos_outer = std::cos(outer)}};
    return View(scene, {0, 0, 4}, {0, 0, 0}).centre().x;
  };
  const float full = 2 * std::cos(angle) / 5;
  EXPECT_NEAR(with_cone(angle + 0.1F, angle + 0.2F), full, 1e-5F);
  EXPECT_EQ(with_cone(angle - 0.2F, angle - 0.1F), 0.0F);
  const float between = (std::cos(angle) - std::cos(0.7F)) / (std::cos(0.2F) - std::cos(0.7F));
  EXPECT_NEAR(with_cone(0.2F, 0.7F), full * between * between, 1e-5F);
}

TEST(Shading, AnOccluderCastsAShadowAndASurfaceNoneOnItself) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.name = "matte", .base_colour = glm::vec3(1)});
  scene.lights.push_back({.position = {0, 0, 3}, .intensity = glm::vec3(4)});
  scene.ambient = glm::vec3(0.0625F);
  const glm::vec3 eye(3, 0, 4);
  EXPECT_GT(View(scene, eye, {0, 0, 0}).centre().x, 0.4F);
  add_wall(scene, 2, 0.5F, {});
  EXPECT_EQ(View(scene, eye, {0, 0, 0}).centre(), glm::vec3(0.0625F));
}

TEST(Shading, NoShadowRayLeavesASurfaceThatFacesAway) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {});
  scene.lights.push_back({.position = {0, 0, -3}});
  const View view(scene, {0, 0, 4}, {0, 0, 0});
  EXPECT_TRUE(view.spy.seen(RayKind::kShadow).empty());
  EXPECT_EQ(view.centre(), glm::vec3(0));
}

TEST(Shading, MirrorSphereShowsTheTintedBackground) {
  traces::Scene scene = empty_scene();
  scene.background = {0.5F, 0.5F, 0.25F};
  const glm::vec3 tint(1, 0.5F, 0.25F);
  traces::add_object(scene, traces::make_sphere("ball", {0, 0, 0}, 1, 16),
                     traces::add_material(scene, {.name = "mirror", .mirror = 1, .mirror_tint = tint}));
  const View view(scene, {0, 0, 6}, {0, 0, 0}, small(33, 33));
  EXPECT_EQ(view.centre(), scene.background * tint);
  EXPECT_EQ(view.picture.at(0, 0), scene.background);
  for (const traces::Ray& ray : view.spy.seen(RayKind::kReflection)) {
    EXPECT_NEAR(glm::length(ray.direction), 1.0F, 1e-5F);
    EXPECT_NEAR(glm::length(ray.origin), 1.0F, 1e-2F);
  }
}

TEST(Shading, MirrorSendsTheRayBackAtTheSameAngle) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.name = "mirror", .mirror = 0.5F});
  const View view(scene, {3, 0, 3}, {0, 0, 0});
  ASSERT_EQ(view.spy.seen(RayKind::kReflection).size(), 81U);
  for (std::size_t i = 0; i < 81; ++i) {
    const glm::vec3 in = view.spy.seen(RayKind::kPrimary)[i].direction;
    expect_near(view.spy.seen(RayKind::kReflection)[i].direction, {in.x, in.y, -in.z}, 1e-6F);
  }
}

TEST(Shading, GlassSlabObeysSnellAndShiftsTheRayAside) {
  constexpr float kIor = 1.5F, kThickness = 1;
  traces::Scene scene = empty_scene();
  const traces::Material glass{.name = "glass", .transmission = 1, .ior = kIor};
  add_wall(scene, 0, 100, glass);
  traces::add_object(scene, traces::make_quad("back", {-50, -50, -kThickness}, {0, 100, 0}, {100, 0, 0}, 1),
                     traces::add_material(scene, glass));
  const View view(scene, {3, 0, 3}, {0, 0, 0}, small(1, 1));
  const float outside = std::numbers::pi_v<float> / 4;
  const float inside = std::asin(std::sin(outside) / kIor);
  const auto& refracted = view.spy.seen(RayKind::kRefraction);
  ASSERT_GE(refracted.size(), 2U);
  expect_near(refracted[0].direction, {-std::sin(inside), 0, -std::cos(inside)}, 1e-5F);
  const traces::Ray& out = refracted[1];  // the second wave's rays; reflections come first, so this ray left through
                                          // the back
  expect_near(out.origin, {-kThickness * std::tan(inside), 0, -kThickness}, 1e-4F);
  expect_near(out.direction, view.spy.seen(RayKind::kPrimary)[0].direction, 1e-5F);
}

TEST(Shading, GlassKeepsAllLight) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(0.5F);
  traces::add_object(scene, traces::make_sphere("ball", {0, 0, 0}, 1, 16),
                     traces::add_material(scene, {.name = "glass", .base_colour = glm::vec3(1), .transmission = 1}));
  RenderConfig config = small(15, 15);
  config.depth = 8;
  config.min_weight = 0;
  EXPECT_NEAR(View(scene, {0, 0, 9}, {0, 0, 0}, config).centre().x, 0.5F, 1e-4F);
  config.depth = 2;  // the ray enters but does not leave: only the mirrored 4 %
  EXPECT_NEAR(View(scene, {0, 0, 9}, {0, 0, 0}, config).centre().x, 0.04F * 0.5F, 1e-4F);
}

/// Returns the colour of a white sky seen head-on through `panes` panes of glass in z = 0.
glm::vec3 seen_through(const traces::Material& glass, int panes, const glm::vec4& vertex_colour = glm::vec4(1),
                       std::uint32_t texel = ~0U) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  scene.textures.push_back({.name = "stain", .width = 1, .height = 1, .texels = {texel}});
  traces::add_material(scene, glass);
  for (int i = 0; i < panes; ++i) {
    traces::Mesh pane = traces::make_quad("pane", {-5, -5, -i}, {10, 0, 0}, {0, 10, 0}, 1);
    if (vertex_colour != glm::vec4(1)) pane.colours.assign(pane.positions.size(), vertex_colour);
    traces::add_object(scene, pane, 0);
  }
  return View(scene, {0, 0, 4}, {0, 0, 0}, small(1, 1)).centre();
}

/// KHR_materials_transmission: transmitted light takes the base colour at each surface.
TEST(Shading, GlassTintsTransmittedLightByItsBaseColour) {
  const traces::Material red{.name = "red", .base_colour = {1, 0, 0}, .transmission = 1, .ior = 1};
  expect_near(seen_through(red, 1), {1, 0, 0}, 1e-5F);
  const traces::Material smoke{.name = "smoke", .base_colour = {0.5F, 0.8F, 1}, .transmission = 1, .ior = 1};
  expect_near(seen_through(smoke, 1), {0.5F, 0.8F, 1}, 1e-5F);
  expect_near(seen_through(smoke, 2), {0.25F, 0.64F, 1}, 1e-5F);
  // The mirrored 4 % (head-on, index 1.5) are white.
  traces::Material bending = red;
  bending.ior = 1.5F;
  expect_near(seen_through(bending, 1), {1, 0.04F, 0.04F}, 1e-5F);
}

TEST(Shading, GlassTintsByItsTextureAndVertexColoursToo) {
  traces::Material stained{.name = "stained", .base_colour = {1, 0.5F, 1}, .transmission = 1, .ior = 1};
  stained.base_texture = {0};
  expect_near(seen_through(stained, 1, glm::vec4(1), 0xffff0000U), {0, 0, 1}, 1e-5F);
  expect_near(seen_through(stained, 1, glm::vec4(0.25F, 1, 0.5F, 1)), {0.25F, 0.5F, 0.5F}, 1e-4F);
  stained.transmission = 0.5F;  // half of the light is scattered, but there is no light
  expect_near(seen_through(stained, 1, glm::vec4(0.25F, 1, 0.5F, 1), 0xff00ffffU), {0.125F, 0.25F, 0}, 1e-4F);
}

TEST(Shading, ReflectionIsTotalBeyondTheCriticalAngle) {
  traces::Scene scene = empty_scene();
  // Seen from within the glass: the wall's outside faces away.
  traces::add_object(scene, traces::make_quad("roof", {-50, -50, 0}, {0, 100, 0}, {100, 0, 0}, 1),
                     traces::add_material(scene, {.name = "glass", .transmission = 1}));
  scene.background = glm::vec3(0.5F);
  const View steep(scene, {1, 0, 2}, {0, 0, 0}, small(1, 1));    // 27 degrees to the normal
  const View grazing(scene, {2, 0, 1}, {0, 0, 0}, small(1, 1));  // 63 degrees; the critical angle is 42
  EXPECT_EQ(steep.spy.seen(RayKind::kRefraction).size(), 1U);
  EXPECT_EQ(grazing.spy.seen(RayKind::kRefraction).size(), 0U);
  EXPECT_EQ(grazing.centre(), glm::vec3(0.5F));
}

TEST(Shading, FaintPathsEnd) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.name = "mirror", .mirror = 0.005F});
  EXPECT_TRUE(View(scene, {0, 0, 4}, {0, 0, 0}).spy.seen(RayKind::kReflection).empty());
  RenderConfig config = small(3, 3);
  config.min_weight = 0.001;
  EXPECT_EQ(View(scene, {0, 0, 4}, {0, 0, 0}, config).spy.seen(RayKind::kReflection).size(), 9U);
}

}  // namespace
}  // namespace kernels
