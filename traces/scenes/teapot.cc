#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>

#include "sim/hash.h"
#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"
#include "traces/scenes/teapot_patches.h"

namespace traces {
namespace {

/// Makes one mesh of the patches, each in cells x cells, without the triangles at the poles that have no area.
Mesh make_pot(std::string name, std::span<const BezierPatch> patches, std::uint32_t cells) {
  Mesh mesh;
  mesh.name = std::move(name);
  for (const BezierPatch& patch : patches) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t j = 0; j <= cells; ++j) {
      for (std::uint32_t i = 0; i <= cells; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(cells);
        const float v = static_cast<float>(j) / static_cast<float>(cells);
        const SurfacePoint point = evaluate(patch, u, v);
        mesh.positions.push_back(point.position);
        mesh.normals.push_back(point.normal);
        mesh.uvs.emplace_back(u, v);
      }
    }
    add_grid(mesh, first, cells, cells);
  }
  std::erase_if(mesh.triangles, [&mesh](const std::array<std::uint32_t, 3>& t) {
    constexpr float kNothing = 1e-6F;
    const glm::vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
    return glm::length(glm::cross(b - a, c - a)) < kNothing;
  });
  return mesh;
}

/// Makes four squares with a fine grain, so that neighbouring texels differ.
Texture make_checker() {
  constexpr std::uint32_t kSize = 256;
  Texture texture;
  texture.name = "checker";
  texture.width = texture.height = kSize;
  for (std::uint32_t y = 0; y < kSize; ++y) {
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const bool light = (x < kSize / 2) == (y < kSize / 2);
      const auto grain = static_cast<std::uint32_t>(sim::hash(x, y) % 17);
      const std::uint32_t r = (light ? 214U : 66U) + grain;
      const std::uint32_t g = (light ? 208U : 74U) + grain;
      const std::uint32_t b = (light ? 192U : 92U) + grain;
      texture.texels.push_back(r | (g << 8) | (b << 16) | (255U << 24));
    }
  }
  return texture;
}

}  // namespace

Scene build_teapot(const BuiltinOptions& options) {
  constexpr std::uint32_t kTriangles = 14'792;  // with 15 and 16 cells
  const Detail detail = detail_for(options.triangles_or(kTriangles), kTriangles);
  Scene scene;
  scene.name = "teapot";
  scene.textures.push_back(make_checker());

  Material porcelain, floor;
  porcelain.name = "glazed porcelain";
  porcelain.base_colour = {0.80F, 0.29F, 0.16F};
  porcelain.mirror = 0.15F;
  floor.name = "checkered floor";
  floor.base_colour = glm::vec3(1);
  floor.base_texture.texture = 0;
  const std::uint32_t porcelain_id = add_material(scene, porcelain);
  const std::uint32_t floor_id = add_material(scene, floor);

  const std::vector<BezierPatch> patches = teapot_patches();
  add_object(scene, make_pot("teapot", patches, detail.cells(15, 3)), porcelain_id);
  add_object(scene, make_quad("floor", {-12, 0, -12}, {0, 0, 24}, {24, 0, 0}, detail.cells(16, 2), 12), floor_id);

  Light lamp;
  lamp.position = {-5, 9, 7};
  lamp.intensity = glm::vec3(1, 0.95F, 0.88F);
  scene.lights.push_back(lamp);
  scene.cameras.push_back(look_at("front", {1.2F, 4.2F, 8.6F}, {0.2F, 1.3F, 0}, 0.5F));
  // Once round the pot.
  std::vector<ViewKey> path;
  for (int k = 0; k <= 8; ++k) {
    const glm::vec2 way = on_circle(0.25 - k / 8.0);
    path.push_back({1.5F * static_cast<float>(k), {0.2F + 8.6F * way.x, 4.2F, 8.6F * way.y}, {0.2F, 1.3F, 0}});
  }
  add_camera_path(scene, "path", path, 0.5F);
  finish_scene(scene);
  return scene;
}

}  // namespace traces
