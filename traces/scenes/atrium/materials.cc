#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/atrium/parts.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::atrium {
namespace {

/// Slabs of two stones with small dark squares at the corners.
glm::vec4 floor_slabs(float u, float v) {
  const float x = u * 4 - std::floor(u * 4), y = v * 4 - std::floor(v * 4);
  const auto i = static_cast<std::uint64_t>(u * 4), j = static_cast<std::uint64_t>(v * 4);
  const float corner = std::abs(std::abs(x - 0.5F) - 0.5F) + std::abs(std::abs(y - 0.5F) - 0.5F);
  const float edge = std::min(std::min(x, 1 - x), std::min(y, 1 - y));
  const float cloud = fractal(u, v, 8, 5, 17);
  if (corner < 0.2F) return {glm::vec3(0.24F, 0.16F, 0.14F) * (0.8F + 0.5F * cloud), 1};
  if (edge < 0.012F || corner < 0.216F) return {0.38F, 0.34F, 0.30F, 1};
  const glm::vec3 slab = (i + j) % 2 == 0 ? glm::vec3(0.76F, 0.68F, 0.56F) : glm::vec3(0.66F, 0.55F, 0.44F);
  return {slab * (0.82F + 0.1F * random(3, i, j) + 0.25F * (cloud - 0.4F)), 1};
}

/// A woven banner: a border, a field and an eight-pointed star.
glm::vec4 banner(float u, float v, const glm::vec3& ground) {
  const glm::vec3 gold(0.86F, 0.66F, 0.24F);
  const float weave =
      0.86F + 0.2F * random(8, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 384));
  glm::vec3 c = ground;
  const float edge = std::min(std::min(u, 1 - u), 0.4F * std::min(v, 1 - v) * 3);
  if (edge > 0.06F && edge < 0.1F) c = gold;
  const glm::vec2 d(u - 0.5F, (v - 0.42F) * 3);
  const float upright = std::max(std::abs(d.x), std::abs(d.y)), tilted = (std::abs(d.x) + std::abs(d.y)) * 0.7071F;
  const float star = std::min(upright, tilted);
  if (star < 0.26F) c = gold;
  if (star < 0.2F) c = 0.6F * ground;
  if (glm::length(d) < 0.13F) c = gold;
  const glm::vec2 e(u - 0.5F, (v - 0.78F) * 3);
  if (std::abs(std::abs(e.x) + std::abs(e.y) - 0.2F) < 0.03F) c = gold;
  return {c * weave, 1};
}

glm::vec4 curtain(float u, float v) {
  const float weave =
      0.85F + 0.2F * random(9, static_cast<std::uint64_t>(u * 192), static_cast<std::uint64_t>(v * 192));
  const float row = v * 5 - std::floor(v * 5), x = u * 6 - std::floor(u * 6) - 0.5F;
  glm::vec3 c = glm::mix(glm::vec3(0.20F, 0.42F, 0.28F), glm::vec3(0.15F, 0.33F, 0.24F), fractal(u, v, 8, 3, 5));
  if (row < 0.06F || (row > 0.1F && row < 0.13F)) c = {0.80F, 0.66F, 0.32F};
  if (std::abs(x) + std::abs(row - 0.56F) < 0.14F) c = {0.66F, 0.52F, 0.26F};
  return {c * weave, 1};
}

}  // namespace

void paint_pictures(Scene& scene) {
  scene.textures = {
      brick_texture("ashlar", {0.87F, 0.79F, 0.65F}, {0.66F, 0.59F, 0.48F}, 4, 6, 41, 512),
      brick_texture("brick", {0.80F, 0.53F, 0.39F}, {0.76F, 0.70F, 0.62F}, 6, 14, 42, 512),
      paint_texture("floor slabs", 1024, 1024, floor_slabs),
      stone_texture("stone", {0.90F, 0.83F, 0.71F}, {0.68F, 0.60F, 0.49F}, 43, 512),
      wood_texture("oak", {0.44F, 0.28F, 0.16F}, {0.24F, 0.14F, 0.08F}, 44, 256),
      paint_texture("red banner", 256, 768,
                    [](float u, float v) {
                      return banner(u, v, {0.66F, 0.10F, 0.09F});
                    }),
      paint_texture("blue banner", 256, 768,
                    [](float u, float v) {
                      return banner(u, v, {0.10F, 0.20F, 0.48F});
                    }),
      paint_texture("curtain", 512, 512, curtain),
  };
}

Materials add_materials(Scene& scene) {
  const auto with_picture = [&scene](const char* name, Picture picture, const glm::vec3& colour = glm::vec3(1),
                                     float mirror = 0) {
    return add_material(scene, textured(name, picture, colour, mirror));
  };
  Material glow = lamp("lantern", {0.99F, 0.80F, 0.48F});
  glow.casts_light = false;
  Materials is{};
  is.ashlar = with_picture("ashlar", kAshlar);
  is.brick = with_picture("brick", kBrick);
  is.floor = with_picture("polished floor", kFloor, glm::vec3(1), 0.14F);
  is.stone = with_picture("stone", kStone);
  is.light_stone = with_picture("light stone", kStone, glm::vec3(1.0F, 0.98F, 0.95F));
  is.wood = with_picture("oak", kWood);
  is.plaster = add_material(scene, paint("plaster", {0.80F, 0.73F, 0.62F}));
  is.red = with_picture("red banner", kRedBanner);
  is.blue = with_picture("blue banner", kBlueBanner);
  is.curtain = with_picture("curtain", kCurtain);
  is.iron = add_material(scene, paint("iron", {0.07F, 0.065F, 0.06F}));
  is.leaf = add_material(scene, paint("leaves", {0.17F, 0.38F, 0.11F}));
  is.clay = add_material(scene, paint("clay", {0.68F, 0.38F, 0.24F}));
  is.soil = add_material(scene, paint("soil", {0.14F, 0.10F, 0.07F}));
  is.water = add_material(scene, paint("water", {0.10F, 0.22F, 0.24F}, 0.45F));
  is.glow = add_material(scene, glow);
  return is;
}

}  // namespace traces::atrium
