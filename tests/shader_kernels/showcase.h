#pragma once
#include <cstdint>

#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/modelling/shapes.h"

namespace kernels {

/// Adds a texture of side x side texels; texel (x, y) is `texel(x, y)`.
inline std::uint32_t add_texture(traces::Scene& scene, std::uint32_t side, bool srgb, auto&& texel) {
  traces::Texture t;
  t.width = t.height = side;
  t.srgb = srgb;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) t.texels.push_back(texel(x, y));
  }
  scene.textures.push_back(std::move(t));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

/// Returns a quad whose tangents follow its texture coordinates.
inline traces::Mesh tangent_quad(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v, float repeats = 1) {
  traces::Mesh mesh = traces::make_quad("quad", corner, u, v, 1, repeats);
  mesh.tangents.assign(mesh.positions.size(), glm::vec4(glm::normalize(u), 1));
  return mesh;
}

/// Indices of the showcase's materials.
struct ShowcaseMaterials {
  std::uint32_t floor, leaves, cloth, glass, sign, paint;
};

inline ShowcaseMaterials add_showcase_materials(traces::Scene& scene) {
  using Alpha = traces::Material::Alpha;
  const std::uint32_t tiles = add_texture(
      scene, 8, true, [](std::uint32_t x, std::uint32_t y) { return (x ^ y) & 1U ? 0xff8090d0U : 0xff304060U; });
  scene.textures[tiles].filter = traces::Texture::Filter::kNearest;
  const std::uint32_t leaf = add_texture(scene, 16, true, [](std::uint32_t x, std::uint32_t y) {
    const int dx = 2 * static_cast<int>(x) - 15, dy = 2 * static_cast<int>(y) - 15;
    return dx * dx + dy * dy < 170 ? 0xff30a040U : 0x0030a040U;
  });
  const std::uint32_t curtain =
      add_texture(scene, 8, true, [](std::uint32_t x, std::uint32_t) { return 0x2040c0ffU + (x * 0x18000000U); });
  const std::uint32_t metal = add_texture(
      scene, 8, false, [](std::uint32_t x, std::uint32_t y) { return 0xff000000U | (x * 32) << 16 | (y * 32) << 8; });
  const std::uint32_t bumps = add_texture(
      scene, 8, false, [](std::uint32_t x, std::uint32_t y) { return 0xffe00000U | (96 + 9 * y) << 8 | (96 + 9 * x); });
  const std::uint32_t dirt = add_texture(
      scene, 4, false, [](std::uint32_t x, std::uint32_t y) { return 0xff000000U | (80 * (x + y) / 3 + 90); });
  const std::uint32_t sign = add_texture(
      scene, 4, true, [](std::uint32_t x, std::uint32_t y) { return (x + y) % 2 ? 0xff20f0ffU : 0xff000000U; });

  ShowcaseMaterials materials{};
  materials.floor = traces::add_material(scene, {.name = "floor",
                                                 .base_texture = {tiles},
                                                 .metal_rough_texture = {metal},
                                                 .metallic = 1,
                                                 .roughness = 0.5F,
                                                 .normal_texture = {bumps},
                                                 .occlusion_texture = {dirt}});
  materials.leaves = traces::add_material(
      scene, {.name = "leaves", .base_texture = {leaf}, .alpha = Alpha::kMask, .alpha_cutoff = 0.5F});
  materials.cloth = traces::add_material(
      scene, {.name = "cloth", .base_texture = {curtain, true}, .alpha = Alpha::kBlend, .opacity = 0.9F});
  materials.glass = traces::add_material(
      scene, {.name = "glass", .base_colour = {0.9F, 0.95F, 1}, .transmission = 1, .absorption = {1.5F, 0.5F, 0.1F}});
  materials.sign = traces::add_material(
      scene, {.name = "sign", .base_colour = glm::vec3(0), .emission = glm::vec3(0.9F), .emission_texture = {sign}});
  materials.paint = traces::add_material(scene, {.name = "paint", .base_colour = glm::vec3(1)});
  return materials;
}

inline void add_showcase_objects(traces::Scene& scene, const ShowcaseMaterials& materials) {
  traces::add_object(scene, tangent_quad({-3, -1, 2}, {6, 0, 0}, {0, 0, -5}, 3), materials.floor);
  traces::Mesh wall = traces::make_quad("wall", {-3, -1, -2.5F}, {6, 0, 0}, {0, 3, 0}, 1);
  wall.colours = {{1, 0.2F, 0.2F, 1}, {0.2F, 1, 0.2F, 1}, {0.2F, 0.2F, 1, 1}, {1, 1, 0.3F, 1}};
  traces::add_object(scene, std::move(wall), materials.paint);
  for (int i = 0; i < 6; ++i) {
    const auto f = static_cast<float>(i);
    traces::add_object(
        scene, traces::make_quad("leaf", {-2.4F + 0.25F * f, -1, -1 + 0.35F * f}, {1.2F, 0, 0.2F}, {0, 1.8F, 0}, 1, 2),
        materials.leaves);
  }
  traces::Mesh hanging = traces::make_quad("curtain", {0.3F, -0.8F, -1.2F}, {1.6F, 0, 0}, {0, 2, 0}, 1);
  hanging.second_uvs = hanging.uvs;
  hanging.uvs.assign(hanging.uvs.size(), glm::vec2(0));
  traces::add_object(scene, std::move(hanging), materials.cloth);
  traces::add_object(scene, traces::make_sphere("ball", {0.7F, -0.4F, 0.4F}, 0.55F, 6), materials.glass);
  traces::add_object(scene, traces::make_quad("sign", {1.6F, 0.2F, -1}, {0.8F, 0, 0.5F}, {0, 0.8F, 0}, 1),
                     materials.sign);
}

/// Returns a small room with every material feature: leaves with holes before a tiled floor with normal, metal and
/// occlusion maps, a blended curtain, coloured glass, a glowing sign, painted vertices.
inline traces::Scene showcase_scene() {
  traces::Scene scene;
  scene.name = "showcase";
  add_showcase_objects(scene, add_showcase_materials(scene));

  scene.lights.push_back({.kind = traces::Light::Kind::kDirectional,
                          .direction = glm::normalize(glm::vec3(0.3F, -1, -0.6F)),
                          .intensity = glm::vec3(0.7F)});
  scene.lights.push_back({.position = {-0.5F, 1.5F, 1.5F}, .intensity = glm::vec3(1.2F), .range = 5});
  scene.ambient = glm::vec3(0.2F);
  scene.cameras.push_back(traces::look_at("front", {0, 0.6F, 4.2F}, {0, 0, 0}, 0.8F));
  return scene;
}

}  // namespace kernels
