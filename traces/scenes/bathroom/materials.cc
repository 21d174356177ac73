#include <cmath>

#include <glm/common.hpp>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

glm::vec4 marble(float u, float v) {
  const float bend = fractal(u, v, 4, 5, 3);
  const float vein = std::abs(sin_turns(static_cast<double>(2 * u + v + 2.2F * bend)));
  const float thin = vein < 0.12F ? 1 - vein / 0.12F : 0.0F;
  const glm::vec3 ground =
      glm::mix(glm::vec3(0.80F, 0.79F, 0.77F), glm::vec3(0.90F, 0.895F, 0.88F), fractal(u, v, 9, 3, 8));
  return {glm::mix(ground, glm::vec3(0.52F, 0.52F, 0.54F), 0.7F * thin * bend), 1};
}

glm::vec4 stripes(float u, float v) {
  const float row = v * 9 - std::floor(v * 9);
  const float loop = 0.8F + 0.3F * random(4, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 128));
  const glm::vec3 ink = row < 0.45F ? glm::vec3(0.16F, 0.36F, 0.52F) : glm::vec3(0.87F, 0.86F, 0.82F);
  return {ink * loop, 1};
}

glm::vec4 terry(float u, float v) {
  const float loop = 0.78F + 0.3F * random(5, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 128));
  return {glm::vec3(0.93F, 0.72F, 0.60F) * loop * (0.92F + 0.12F * fractal(u, v, 8, 3, 6)), 1};
}

/// A bottle's label; u runs round the bottle.
glm::vec4 label(float u, float v) {
  glm::vec3 c(0.93F, 0.92F, 0.86F);
  const float x = u * 2 - std::floor(u * 2);
  if (v > 0.3F && v < 0.72F && x > 0.15F && x < 0.85F) {
    c = {0.95F, 0.95F, 0.93F};
    if (v < 0.44F) c = {0.22F, 0.42F, 0.38F};
    const auto row = static_cast<std::uint64_t>(v * 48);
    if (v > 0.48F && v < 0.68F && row % 2 == 0 && x > 0.22F && x < 0.6F + 0.2F * random(6, row)) c = glm::vec3(0.3F);
  }
  return {c, 1};
}

}  // namespace

void paint_pictures(Scene& scene) {
  scene.textures = {paint_texture("marble", 512, 512, marble),
                    wood_texture("oak", {0.74F, 0.56F, 0.36F}, {0.55F, 0.37F, 0.20F}, 14, 512),
                    paint_texture("terry", 256, 256, terry), paint_texture("stripes", 256, 256, stripes),
                    paint_texture("label", 256, 256, label)};
}

Materials add_materials(Scene& scene) {
  const auto with_paint = [&scene](const char* name, const glm::vec3& colour, float mirror = 0) {
    return add_material(scene, paint(name, colour, mirror));
  };
  const auto with_picture = [&scene](const char* name, Picture picture, float mirror = 0) {
    return add_material(scene, textured(name, picture, glm::vec3(1), mirror));
  };
  Material ceiling = paint("ceiling", {0.86F, 0.86F, 0.85F});
  ceiling.emission = {0.3F, 0.295F, 0.285F};  // light that the room reflects to the ceiling
  Material bulb = lamp("bulb", {0.99F, 0.95F, 0.86F});
  ceiling.casts_light = bulb.casts_light = false;
  Materials is{};
  is.tile = with_paint("white tile", {0.80F, 0.83F, 0.82F}, 0.05F);
  is.accent = with_paint("teal tile", {0.10F, 0.36F, 0.38F}, 0.07F);
  is.grout = with_paint("grout", {0.60F, 0.60F, 0.58F});
  is.floor = with_picture("marble floor", kMarble);
  is.wall = with_paint("wall paint", {0.78F, 0.83F, 0.80F});
  is.ceiling = add_material(scene, ceiling);
  is.enamel = with_paint("enamel", {0.90F, 0.90F, 0.89F}, 0.05F);
  is.chrome = add_material(scene, metal("chrome", {0.90F, 0.91F, 0.93F}, 0.82F));
  is.mirror = add_material(scene, metal("mirror", glm::vec3(0.93F), 0.95F));
  is.glass = add_material(scene, glass("shower screen", {0.94F, 0.98F, 0.965F}, 1.0F));
  is.oak = with_picture("oak", kOak);
  is.stone = with_picture("marble top", kMarble, 0.05F);
  is.white = with_paint("white lacquer", {0.88F, 0.88F, 0.87F});
  is.towel = with_picture("terry towel", kTerry);
  is.striped = with_picture("striped towel", kStripes);
  is.mat = with_paint("bath mat", {0.20F, 0.42F, 0.48F});
  is.bristle = with_paint("bristles", {0.86F, 0.82F, 0.70F});
  is.wire = with_paint("black wire", {0.06F, 0.06F, 0.065F});
  is.bottle = with_picture("labelled bottle", kLabel);
  is.blue = with_paint("blue plastic", {0.10F, 0.30F, 0.62F});
  is.green = with_paint("green plastic", {0.22F, 0.52F, 0.26F});
  is.amber = with_paint("amber soap", {0.80F, 0.42F, 0.10F}, 0.06F);
  is.rose = with_paint("rose", {0.82F, 0.34F, 0.42F});
  is.duck = with_paint("rubber duck", {0.95F, 0.76F, 0.08F});
  is.beak = with_paint("beak", {0.90F, 0.36F, 0.06F});
  is.black = with_paint("black", glm::vec3(0.03F));
  is.leaf = with_paint("leaves", {0.16F, 0.42F, 0.13F});
  is.lamp = add_material(scene, bulb);
  is.water = add_material(scene, glass("clear glass", glm::vec3(1), 1.4F));
  return is;
}

}  // namespace traces::bathroom
