#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::conference {
namespace {

/// Loops of wool with small diamonds in rows.
glm::vec4 carpet(float u, float v) {
  const float x = u * 8 - std::floor(u * 8) - 0.5F, y = v * 8 - std::floor(v * 8) - 0.5F;
  const float diamond = std::abs(x) + std::abs(y);
  const float loop = random(1, static_cast<std::uint64_t>(u * 256), static_cast<std::uint64_t>(v * 256));
  glm::vec3 wool = glm::mix(glm::vec3(0.29F, 0.32F, 0.40F), glm::vec3(0.36F, 0.40F, 0.47F), fractal(u, v, 8, 4, 2));
  if (diamond < 0.12F) wool = {0.62F, 0.56F, 0.44F};
  if (diamond > 0.44F && diamond < 0.5F) wool = {0.44F, 0.45F, 0.48F};
  return {wool * (0.8F + 0.35F * loop), 1};
}

glm::vec4 chart(float u, float v) {
  const glm::vec3 ink(0.15F, 0.2F, 0.3F);
  glm::vec3 c = glm::mix(glm::vec3(0.97F), glm::vec3(0.88F, 0.93F, 0.98F), v);
  if (v < 0.13F) {
    c = {0.13F, 0.29F, 0.5F};
    const bool letters = v > 0.045F && v < 0.09F && u > 0.06F && u < 0.62F;
    if (letters && random(7, static_cast<std::uint64_t>(u * 90)) > 0.3F) c = glm::vec3(0.95F);
  } else if (u > 0.07F && u < 0.93F && v > 0.2F && v < 0.9F) {
    const float x = (u - 0.1F) / 0.8F * 9, y = (0.85F - v) / 0.6F;
    const float bar = 0.25F + 0.07F * std::floor(x) + 0.22F * random(5, static_cast<std::uint64_t>(std::max(x, 0.0F)));
    const float inside = x - std::floor(x);
    if (std::abs(y * 5 - std::floor(y * 5 + 0.5F)) < 0.02F) c *= 0.8F;
    if (x > 0 && x < 9 && inside > 0.15F && inside < 0.6F && y > 0 && y < bar) c = {0.2F, 0.5F, 0.75F};
    if (x > 0 && x < 9 && inside > 0.6F && inside < 0.9F && y > 0 && y < bar * 0.7F) c = {0.93F, 0.58F, 0.2F};
    if (std::abs(u - 0.095F) < 0.003F || std::abs(v - 0.852F) < 0.004F) c = ink;
  }
  return {c, 1};
}

/// Rows of hills, paler with distance.
glm::vec4 hills(float u, float v) {
  glm::vec3 c = glm::mix(glm::vec3(0.95F, 0.75F, 0.5F), glm::vec3(0.35F, 0.55F, 0.8F), std::max(0.0F, 1 - 1.6F * v));
  for (std::uint32_t k = 0; k < 5; ++k) {
    const float near = static_cast<float>(k) / 4;
    const float ridge = 0.38F + 0.13F * static_cast<float>(k) - 0.22F * fractal(u * 0.99F, 0.37F, 3 + k, 5, 20 + k);
    if (v > ridge) c = glm::mix(glm::vec3(0.62F, 0.68F, 0.75F), glm::vec3(0.12F, 0.24F, 0.12F), near);
  }
  return {c * (0.9F + 0.2F * fractal(u, v, 32, 3, 9)), 1};
}

glm::vec4 sea(float u, float v) {
  const float sun = glm::length(glm::vec2(u - 0.68F, (v - 0.34F) * 0.7F));
  glm::vec3 c = glm::mix(glm::vec3(0.25F, 0.45F, 0.75F), glm::vec3(0.95F, 0.72F, 0.55F), std::min(1.0F, 1.9F * v));
  if (sun < 0.07F) c = {1, 0.95F, 0.8F};
  if (v > 0.52F) {
    const float wave = fractal(u, v * v, 12, 4, 33);
    c = glm::mix(glm::vec3(0.08F, 0.28F, 0.42F), glm::vec3(0.45F, 0.62F, 0.68F), wave * wave);
    if (std::abs(u - 0.68F) < 0.05F + 0.08F * wave) c += glm::vec3(0.3F, 0.24F, 0.15F) * wave;
  }
  return {c, 1};
}

/// Blocks of colour between black lines.
glm::vec4 shapes(float u, float v) {
  const float columns[] = {0, 0.22F, 0.64F, 0.8F, 1.01F}, rows[] = {0, 0.3F, 0.48F, 0.83F, 1.01F};
  const glm::vec3 inks[] = {{0.93F, 0.9F, 0.84F}, {0.76F, 0.15F, 0.12F}, {0.93F, 0.9F, 0.84F}, {0.12F, 0.25F, 0.55F},
                            {0.93F, 0.9F, 0.84F}, {0.95F, 0.78F, 0.2F},  {0.9F, 0.88F, 0.82F}};
  std::uint64_t i = 0, j = 0;
  while (u >= columns[i + 1]) ++i;
  while (v >= rows[j + 1]) ++j;
  for (const float line : columns) {
    if (std::abs(u - line) < 0.012F) return {0.08F, 0.08F, 0.08F, 1};
  }
  for (const float line : rows) {
    if (std::abs(v - line) < 0.012F) return {0.08F, 0.08F, 0.08F, 1};
  }
  return {inks[static_cast<std::uint64_t>(random(3, i, j) * 7)] * (0.95F + 0.05F * fractal(u, v, 64, 2, 4)), 1};
}

/// A laptop's screen with a window of text.
glm::vec4 page(float u, float v) {
  glm::vec3 c(0.93F, 0.95F, 0.97F);
  if (v < 0.08F) c = {0.2F, 0.32F, 0.5F};
  if (u < 0.18F && v >= 0.08F) c = {0.78F, 0.83F, 0.88F};
  const float line = v * 24 - std::floor(v * 24);
  const auto row = static_cast<std::uint64_t>(v * 24);
  if (v > 0.12F && v < 0.95F && u > 0.23F && u < 0.6F + 0.33F * random(8, row) && line < 0.45F &&
      random(9, row, static_cast<std::uint64_t>(u * 110)) > 0.22F) {
    c = {0.25F, 0.27F, 0.32F};
  }
  return {c, 1};
}

}  // namespace

void paint_pictures(Scene& scene) {
  scene.textures = {
      paint_texture("carpet", 512, 512, carpet),
      wood_texture("panelling wood", {0.66F, 0.44F, 0.25F}, {0.42F, 0.24F, 0.12F}, 3),
      wood_texture("table wood", {0.50F, 0.28F, 0.15F}, {0.26F, 0.12F, 0.06F}, 5),
      cloth_texture("upholstery", {0.20F, 0.30F, 0.42F}, {0.13F, 0.20F, 0.30F}, 48, 6, 256),
      paint_texture("chart", 512, 512, chart),
      paint_texture("hills", 512, 256, hills),
      paint_texture("sea", 512, 256, sea),
      paint_texture("shapes", 256, 256, shapes),
      paint_texture("page", 256, 256, page),
  };
}

Materials add_materials(Scene& scene) {
  const auto with_picture = [&scene](const char* name, Picture picture, float mirror = 0) {
    return add_material(scene, textured(name, picture, glm::vec3(1), mirror));
  };
  const auto with_paint = [&scene](const char* name, const glm::vec3& colour, float mirror = 0) {
    return add_material(scene, paint(name, colour, mirror));
  };
  Material ceiling = paint("ceiling board", {0.86F, 0.85F, 0.82F});
  ceiling.emission = {0.33F, 0.32F, 0.30F};  // light that the room reflects to the ceiling
  Material panel = lamp("lamp panel", glm::vec3(0.98F, 0.96F, 0.9F));
  Material screen = textured("projection", kChart, glm::vec3(0.25F));
  screen.emission = glm::vec3(0.42F);
  screen.emission_texture.texture = kChart;
  Material glow = textured("laptop screen", kKeys, glm::vec3(0.3F));
  glow.emission = glm::vec3(0.5F);
  glow.emission_texture.texture = kKeys;
  panel.casts_light = screen.casts_light = glow.casts_light = ceiling.casts_light = false;
  Materials is{};
  is.carpet = with_picture("carpet", kCarpet);
  is.wall = with_paint("wall paint", {0.83F, 0.79F, 0.70F});
  is.ceiling = add_material(scene, ceiling);
  is.ceiling_grid = with_paint("ceiling grid", {0.75F, 0.75F, 0.74F});
  is.lamp = add_material(scene, panel);
  is.wood = with_picture("panelling", kWood);
  is.table_wood = with_picture("table top", kTableWood, 0.08F);
  is.white = with_paint("white lacquer", {0.85F, 0.85F, 0.83F});
  is.dark = with_paint("black plastic", {0.045F, 0.045F, 0.05F});
  is.steel = add_material(scene, metal("brushed steel", {0.72F, 0.73F, 0.75F}, 0.45F));
  is.fabric = with_picture("upholstery", kFabric);
  is.chart = with_paint("whiteboard", {0.9F, 0.91F, 0.92F}, 0.04F);
  is.screen = add_material(scene, screen);
  is.hills = with_picture("picture of hills", kHills);
  is.sea = with_picture("picture of the sea", kSea);
  is.shapes = with_picture("picture of shapes", kShapes);
  is.slats = with_paint("window slats", {0.80F, 0.79F, 0.75F});
  is.leaf = with_paint("leaves", {0.13F, 0.36F, 0.10F});
  is.terracotta = with_paint("terracotta", {0.66F, 0.33F, 0.20F});
  is.soil = with_paint("soil", {0.12F, 0.08F, 0.05F});
  is.paper = with_paint("paper", {0.9F, 0.89F, 0.85F});
  is.red = with_paint("red", {0.66F, 0.12F, 0.09F});
  is.blue = with_paint("blue", {0.12F, 0.22F, 0.5F});
  is.china = with_paint("china", {0.88F, 0.87F, 0.84F}, 0.05F);
  is.keys = with_paint("laptop case", {0.42F, 0.43F, 0.45F});
  is.glow = add_material(scene, glow);
  is.brass = add_material(scene, metal("brass", {0.80F, 0.60F, 0.30F}, 0.4F));
  return is;
}

}  // namespace traces::conference
