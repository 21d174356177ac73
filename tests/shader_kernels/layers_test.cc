#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "harness.h"
#include "shader_kernels/catalogue.h"
#include "showcase.h"
#include "traces/accel/embree_tracer.h"
#include "traces/accel/verify.h"

namespace kernels {
namespace {

using traces::Material;
using Alpha = traces::Material::Alpha;
using traces::RayKind;

/// A scene of a white wall at z = 0, lit from the front with irradiance 1, and panes that shade it but are outside the
/// view.
struct Shadow {
  traces::Scene scene = empty_scene();
  Shadow() {
    add_wall(scene, 0, 10, {.name = "wall", .base_colour = glm::vec3(1)});
    scene.lights.push_back(
        {.kind = traces::Light::Kind::kDirectional, .direction = {0, 0, -1}, .intensity = glm::vec3(1)});
  }
  void pane(float z, const Material& material) { add_wall(scene, z, 8, material); }
  glm::vec3 lit(const RenderConfig& config = small(1, 1)) const {
    return View(scene, {0, 0, 0.5F}, {0, 0, 0}, config).centre();
  }
};

/// Adds a texture of two texels: alpha 0 on the left, 1 on the right.
std::uint32_t half_a_leaf(traces::Scene& scene) {
  traces::Texture t{.name = "leaf", .width = 2, .height = 1, .texels = {0x00ffffffU, 0xffffffffU}};
  t.filter = traces::Texture::Filter::kNearest;
  scene.textures.push_back(t);
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

TEST(Layers, RaysPassTheHolesOfAMask) {
  traces::Scene scene = empty_scene();
  scene.ambient = glm::vec3(1);
  add_wall(scene, 0, 10, {.name = "wall", .base_colour = {0, 0, 1}});
  const std::uint32_t leaf = half_a_leaf(scene);
  for (const float z : {0.5F, 1.0F, 1.5F}) {
    add_wall(scene, z, 10, {.base_colour = {0, 1, 0}, .base_texture = {leaf}, .alpha = Alpha::kMask});
  }
  const View view(scene, {0, 0, 4}, {0, 0, 0}, small(8, 8));
  for (std::uint32_t y = 0; y < 8; ++y) {
    for (std::uint32_t x = 0; x < 8; ++x) {
      EXPECT_EQ(view.picture.at(x, y), x < 4 ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0)) << x << ' ' << y;
    }
  }
  EXPECT_EQ(view.picture.rays[0], 64U + 3 * 32U);
  const auto& rays = view.spy.seen(RayKind::kPrimary);
  for (std::size_t i = 64; i < rays.size(); ++i) EXPECT_GT(rays[i].t_min, 2.4F) << "behind what was no surface";
}

TEST(Layers, AContinuingRayDiffersFromTheFirstOnlyInItsStart) {
  traces::Scene scene = empty_scene();
  add_wall(scene, 0, 10, {.alpha = Alpha::kMask, .opacity = 0.4F});
  const View view(scene, {0, 0, 4}, {0, 0, 0}, small(1, 1));
  const auto& rays = view.spy.seen(RayKind::kPrimary);
  ASSERT_EQ(rays.size(), 2U);
  EXPECT_EQ(rays[0].origin, rays[1].origin);
  EXPECT_EQ(rays[0].direction, rays[1].direction);
  EXPECT_EQ(rays[0].t_max, rays[1].t_max);
  EXPECT_GT(rays[1].t_min, 4.0F);
  EXPECT_LT(rays[1].t_min, 4.001F);
}

TEST(Layers, ABlendedShadowIsAsDarkAsItsAlpha) {
  Shadow shadow;
  shadow.pane(1, {.alpha = Alpha::kBlend, .opacity = 0.5F});
  EXPECT_NEAR(shadow.lit().x, 0.5F, 1e-6F);
  shadow.pane(2, {.alpha = Alpha::kBlend, .opacity = 0.25F});
  EXPECT_NEAR(shadow.lit().x, 0.5F * 0.75F, 1e-6F);
  shadow.pane(3, {});
  EXPECT_EQ(shadow.lit().x, 0.0F);
}

TEST(Layers, AMaskedShadowHasHoles) {
  for (const bool hole : {true, false}) {
    Shadow shadow;
    for (const float z : {1.0F, 2.0F, 3.0F}) {
      shadow.pane(z, {.alpha = Alpha::kMask, .opacity = hole ? 0.49F : 0.5F, .alpha_cutoff = 0.5F});
    }
    EXPECT_EQ(shadow.lit().x, hole ? 1.0F : 0.0F);
  }
}

TEST(Layers, GlassTintsShadowsUnlessConfiguredToBlockThem) {
  Shadow shadow;
  shadow.pane(1, {.base_colour = {0.5F, 1, 0.25F}, .transmission = 0.8F});
  shadow.pane(2, {.base_colour = {1, 1, 0.5F}, .transmission = 1});
  expect_near(shadow.lit(), {0.4F, 0.8F, 0.1F}, 1e-6F);
  RenderConfig config = small(1, 1);
  config.glass_shadows = GlassShadows::kOpaque;
  EXPECT_EQ(shadow.lit(config), glm::vec3(0));
}

TEST(Layers, StainedGlassCastsItsPicture) {
  Shadow shadow;
  const std::uint32_t red = add_texture(shadow.scene, 1, true, [](auto, auto) { return 0xff0000ffU; });
  shadow.pane(1, {.base_colour = glm::vec3(1), .base_texture = {red}, .transmission = 1});
  expect_near(shadow.lit(), {1, 0, 0}, 1e-4F);
}

TEST(Layers, NearestHitRaysStillHitGlass) {
  traces::Scene scene = empty_scene();
  scene.background = glm::vec3(1);
  add_wall(scene, 0, 10, {.transmission = 1});
  const View view(scene, {0, 0, 4}, {0, 0, 0}, small(3, 3));
  EXPECT_EQ(view.picture.rays[0], 9U);
  EXPECT_EQ(view.spy.seen(RayKind::kRefraction).size(), 9U);
}

TEST(Layers, BeyondTheLimitASurfaceCountsAsSolid) {
  Shadow shadow;
  for (const float z : {1.0F, 2.0F, 3.0F, 4.0F}) shadow.pane(z, {.alpha = Alpha::kMask, .opacity = 0});
  RenderConfig config = small(1, 1);
  for (const std::uint32_t layers : {0U, 1U, 3U, 4U, 5U}) {
    config.layers = layers;
    EXPECT_EQ(shadow.lit(config).x, layers < 4 ? 0.0F : 1.0F) << layers;
  }
}

TEST(Layers, LightTooFaintToBeSeenEnds) {
  Shadow shadow;
  for (int i = 1; i < 9; ++i) shadow.pane(static_cast<float>(i), {.alpha = Alpha::kBlend, .opacity = 0.95F});
  const View view(shadow.scene, {0, 0, 0.5F}, {0, 0, 0}, small(1, 1));
  EXPECT_EQ(view.picture.rays[static_cast<std::size_t>(RayKind::kShadow)], 3U);  // weights 1, 0.05, 0.0025
  EXPECT_EQ(view.centre().x, 0.0F);
}

TEST(Layers, DarkSurfacesHaveTintedShadowsToo) {
  Shadow shadow;
  shadow.scene.materials[0].base_colour = glm::vec3(0.005F);
  shadow.pane(1, {.base_colour = glm::vec3(1), .transmission = 0.8F});
  shadow.pane(2, {.alpha = Alpha::kMask, .opacity = 0});
  EXPECT_NEAR(shadow.lit().x, 0.004F, 1e-6F);
}

TEST(Layers, VertexColoursAndSecondCoordinatesCount) {
  for (const bool second : {false, true}) {
    Shadow shadow;
    const std::uint32_t leaf = half_a_leaf(shadow.scene);
    shadow.pane(1, {.base_texture = {leaf, second}, .alpha = Alpha::kBlend});
    traces::Mesh& mesh = shadow.scene.meshes.back();
    mesh.uvs.assign(4, {0.25F, 0.5F});
    mesh.second_uvs.assign(4, {0.75F, 0.5F});
    mesh.colours.assign(4, {1, 1, 1, 0.5F});
    EXPECT_NEAR(shadow.lit().x, second ? 0.5F : 1.0F, 1e-4F);
  }
}

TEST(Layers, ContinuingRaysAreCountedTwice) {
  const traces::Scene scene = showcase_scene();
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer tracer(image);
  const FullProgram program(image, scene.cameras[0], small(64, 48), 1, 0);
  TileResult tile;
  std::uint64_t continued = 0, primary = 0;
  for (std::uint32_t t = 0; t < program.tiles(); ++t) {
    program.run_tile(t, tracer, true, tile);
    std::uint64_t rays = 0, scattered = 0;
    for (const std::uint64_t n : tile.rays) rays += n;
    EXPECT_EQ(rays, tile.work.ray_begin.size());
    for (const traces::WorkNode& node : tile.work.nodes) {
      if (node.kind == traces::WorkNode::Kind::kLaunch && node.kernel == kKernelId<ScatterLayers>) {
        scattered += node.items;
      }
    }
    EXPECT_EQ(tile.continued, scattered);
    continued += tile.continued;
    primary += tile.rays[0];
  }
  EXPECT_GT(primary, 64U * 48U);
  EXPECT_GT(continued, primary - 64U * 48U) << "shadow rays go on as well";
}

TEST(Layers, EmbreeAgreesOnEveryRayAndSeesTheSamePicture) {
  const traces::Scene scene = showcase_scene();
  const traces::MemoryImage image = traces::build_memory_image(scene);
  const traces::BvhTracer bvh(image);
  const traces::EmbreeTracer embree(image, 1);
  const traces::VerifyingTracer verifying(image, bvh, embree);
  const Picture ours = render(image, scene.cameras[0], verifying, small(192, 128));
  EXPECT_EQ(verifying.verify_counts().error_count(), 0U);
  EXPECT_GT(verifying.verify_counts().rays, 50000U);
  const Picture truth = render(image, scene.cameras[0], embree, small(192, 128));
  std::uint64_t different = 0;
  for (std::size_t i = 0; i < ours.rgb.size(); ++i) different += std::abs(ours.rgb[i] - truth.rgb[i]) > 0.02F ? 1U : 0U;
  EXPECT_LT(different, ours.rgb.size() / 500);
}

}  // namespace
}  // namespace kernels
