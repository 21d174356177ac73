#include <algorithm>
#include <cmath>
#include <string>

#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/forest/generator.h"
#include "traces/scenes/forest/textures.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces {
namespace forest {

float ground(float x, float z) {
  const float r = std::sqrt(x * x + z * z);
  const float t = std::clamp((r - 2.5F) / 9, 0.0F, 1.0F);
  return 2.6F * (fractal(glm::vec3(x / 9, z / 9, 4), 3, 7) - 0.5F) * t * t * (3 - 2 * t);
}

void Forest::build() {
  add_floor();
  add_backdrop();
  add_trees();
  add_focus();
  add_stones_and_logs();
  add_ferns();
  add_mushrooms();
  fill();
}

std::uint32_t Forest::material(Texture texture, float mirror) {
  scene_.textures.push_back(std::move(texture));
  const auto index = static_cast<std::uint32_t>(scene_.textures.size() - 1);
  return add_material(scene_, textured(scene_.textures.back().name, index, glm::vec3(1), mirror));
}

void Forest::show(const Pieces& pieces, const glm::mat4& at, bool focus) {
  for (const auto& [mesh, paint] : pieces) {
    scene_.instances[add_instance(scene_, add_mesh(scene_, mesh, paint), at)].focus = focus;
  }
}

void Forest::add_floor() {
  const std::uint32_t cells = fine(84, 24);
  Mesh floor = make_surface("forest floor", cells, cells, [](float s, float t) {
    const glm::vec2 p = (glm::vec2(s, 1 - t) - 0.5F) * 64.0F;
    // Denser in the middle.
    const glm::vec2 near = p * (0.35F + 0.65F * glm::abs(p) / 32.0F);
    return on_ground(near.x, near.y);
  });
  for (std::size_t i = 0; i < floor.uvs.size(); ++i) {
    floor.uvs[i] = glm::vec2(floor.positions[i].x, floor.positions[i].z) / 2.6F;
  }
  litter_ = material(litter_texture("leaf litter", 2600, 3));
  add_object(scene_, std::move(floor), litter_);
}

void Forest::add_backdrop() {
  constexpr float kRadius = 31;
  Mesh round = make_surface(
      "deep forest", fine(40, 20), 4,
      [](float s, float t) {
        const glm::vec2 way = on_circle(static_cast<double>(s)) * kRadius;
        return glm::vec3(way.x, -3 + 17 * t, way.y);
      },
      true);
  for (glm::vec2& uv : round.uvs) uv = {5 * uv.x, 1 - uv.y};
  const std::uint32_t deep = material(deep_forest_texture("deep forest"));
  scene_.textures.back().wrap_v = Texture::Wrap::kClamp;
  add_object(scene_, std::move(round), deep);
}

void Forest::add_focus() {
  const std::uint32_t fur = material(fur_texture("deer fur"));
  const std::uint32_t horn = material(bark_texture("antler", {0.42F, 0.33F, 0.24F}, {0.88F, 0.80F, 0.66F}, 6, 51, 256));
  const std::uint32_t dark = add_material(scene_, paint("hoof and eye", {0.02F, 0.016F, 0.014F}, 0.12F));
  show(make_deer(fine(18, 8), fur, horn, dark), placed(on_ground(-1.0F, -1.5F), 0.06), true);

  const std::uint32_t wood = material(wood_texture("bench wood", {0.72F, 0.56F, 0.38F}, {0.36F, 0.24F, 0.15F}, 52));
  const std::uint32_t iron = add_material(scene_, paint("iron", {0.05F, 0.05F, 0.06F}, 0.15F));
  const std::uint32_t flame = add_material(scene_, lamp("flame", {34, 22, 9}));
  const glm::mat4 bench = placed(on_ground(1.75F, -0.1F), -0.06);
  show(make_bench(wood, iron), bench, true);
  show(make_lantern(iron, flame), bench * placed({0.45F, 0.46F, 0}), true);

  caps_ = {material(cap_texture("fly agaric", {0.80F, 0.10F, 0.05F}, 53)),
           material(cap_texture("brown cap", {0.55F, 0.34F, 0.18F}, 54))};
  gills_ = material(gills_texture("gills"));
  stem_ = material(bark_texture("stem", {0.74F, 0.68F, 0.56F}, {0.98F, 0.95F, 0.88F}, 12, 55, 256));
  constexpr float kBig[][4] = {
      {-1.62F, 2.35F, 0.5F, 0.25F}, {-1.12F, 2.62F, 0.33F, 0.5F}, {-2.02F, 2.75F, 0.27F, 0.9F}};
  for (const auto& m : kBig) {
    show(make_mushroom(m[2], m[3], fine(36, 12), caps_[0], gills_, stem_), placed(on_ground(m[0], m[1])), true);
  }
}

}  // namespace forest

Scene build_forest(const BuiltinOptions& options) {
  constexpr float kFov = 0.66F;
  Scene scene;
  scene.name = "forest";
  scene.background = {0.66F, 0.76F, 0.72F};
  forest::Forest(scene, options.triangles_or(forest::kTriangles)).build();
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.42F, -0.82F, -0.38F));
  sun.intensity = {1, 0.93F, 0.76F};
  scene.lights.push_back(sun);
  scene.cameras.push_back(look_at("clearing", {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}, kFov));
  scene.cameras.push_back(look_at("mushrooms", {-0.7F, 0.5F, 4.1F}, {-1.5F, 0.28F, 2.4F}, kFov));
  scene.cameras.push_back(look_at("deer", {0.6F, 1.3F, 1.6F}, {-0.7F, 1.15F, -1.5F}, kFov));
  const ViewKey keys[] = {
      {0, {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}},  {3, {-0.4F, 0.8F, 4.4F}, {-1.4F, 0.4F, 2.3F}},
      {5.5F, {0.5F, 0.9F, 3.2F}, {-0.9F, 0.8F, 0}},      {8, {0.9F, 1.3F, 1.9F}, {-0.8F, 1.2F, -1.5F}},
      {10.5F, {0.4F, 1.35F, 1.8F}, {1.8F, 0.6F, -0.1F}}, {13, {-0.9F, 1.6F, 3.0F}, {1.0F, 2.2F, -2}},
      {15, {-0.5F, 1.35F, 6.3F}, {0.15F, 0.82F, -1.0F}}};
  add_camera_path(scene, "path", keys, kFov);
  finish_scene(scene, {0.33F, 0.37F, 0.35F});
  return scene;
}

}  // namespace traces
