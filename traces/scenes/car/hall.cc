#include "traces/scenes/car/hall.h"

#include <utility>

#include <glm/common.hpp>

#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/turned.h"

namespace traces::car {
namespace {

constexpr float kEnd = 16, kSide = 7.5F, kHeight = 5.2F;

std::uint32_t add_texture(Scene& scene, Texture texture) {
  scene.textures.push_back(std::move(texture));
  return static_cast<std::uint32_t>(scene.textures.size() - 1);
}

/// Concrete slabs with joints and the holes of their formwork.
Texture concrete_texture() {
  return paint_texture("concrete", 512, 512, [](float u, float v) {
    const float cloud = fractal(u, v, 5, 6, 41),
                speck = random(42, static_cast<std::uint64_t>(u * 512), static_cast<std::uint64_t>(v * 512));
    const float from_u = std::min(u, 1 - u), from_v = std::min(v, 1 - v);
    float shade = 0.64F + 0.26F * (cloud - 0.5F) + 0.05F * (speck - 0.5F);
    if (from_u < 0.006F || from_v < 0.006F) shade *= 0.45F;
    const glm::vec2 hole = glm::abs(glm::vec2(from_u - 0.2F, from_v - 0.2F));
    if (hole.x * hole.x + hole.y * hole.y < 0.015F * 0.015F) shade *= 0.4F;
    return glm::vec4(shade, shade * 0.985F, shade * 0.96F, 1);
  });
}

/// A floor with two white lines and worn paint; u runs along the hall.
Texture floor_texture() {
  return paint_texture("painted floor", 1024, 512, [](float u, float v) {
    const float cloud = fractal(u, v, 8, 6, 43);
    const float shade = 0.24F + 0.16F * (cloud - 0.5F);
    glm::vec3 colour(shade, shade * 1.02F, shade * 1.08F);
    for (const float line : {0.30F, 0.70F}) {
      const bool is_on = line < 0.5F || u * 8 - static_cast<float>(static_cast<int>(u * 8)) < 0.55F;
      if (std::abs(v - line) < 0.006F && is_on && cloud > 0.32F)
        colour = glm::vec3(0.85F, 0.83F, 0.76F) * (0.75F + 0.4F * cloud);
    }
    return glm::vec4(colour, 1);
  });
}

}  // namespace

void add_hall(Scene& scene, const Detail& detail) {
  const std::uint32_t concrete = add_material(scene, textured("concrete", add_texture(scene, concrete_texture())));
  const std::uint32_t floor =
      add_material(scene, textured("painted floor", add_texture(scene, floor_texture()), glm::vec3(1), 0.14F));
  const std::uint32_t dark = add_material(scene, paint("dark steel", {0.07F, 0.075F, 0.08F}, 0.08F));
  const std::uint32_t glow = add_material(scene, lamp("light column", {0.92F, 0.95F, 0.98F}));
  const std::uint32_t bright = add_material(scene, lamp("ceiling light", {30, 29, 27}));

  const glm::vec3 x(2 * kEnd, 0, 0), y(0, kHeight, 0), z(0, 0, 2 * kSide);
  const glm::vec3 low(-kEnd, 0, -kSide), high(kEnd, kHeight, kSide);
  const auto wall = [&](const char* name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                        const glm::vec2& repeats, std::uint32_t material) {
    Mesh quad = make_quad(name, corner, u, v, detail.cells(8));
    scale_uvs(quad, repeats);
    add_object(scene, std::move(quad), material);
  };
  Mesh ground = make_quad("floor", {-kEnd, 0, kSide}, x, -z, detail.cells(12));
  add_object(scene, std::move(ground), floor);
  wall("back wall", low, x, y, {12, 2}, concrete);
  wall("front wall", high, -x, -y, {12, 2}, concrete);
  wall("left end", low, y, z, {2, 6}, concrete);
  wall("right end", high, -y, -z, {2, 6}, concrete);
  wall("ceiling", high, -z, -x, {6, 12}, dark);

  // Columns of light between ribs of steel.
  const std::uint32_t column =
      add_mesh(scene, make_box("light column", {-0.09F, 0.25F, 0}, {0.09F, 4.3F, 0.08F}), glow);
  const std::uint32_t rib =
      add_mesh(scene, make_rounded_box("rib", {-0.25F, 0, 0}, {0.25F, kHeight, 0.45F}, 0.06F, detail.cells(2)), dark);
  const std::uint32_t beam =
      add_mesh(scene, make_box("beam", {-0.2F, kHeight - 0.5F, -kSide}, {0.2F, kHeight, kSide}), dark);
  for (int k = 0; k < 8; ++k) {
    const float at = -14 + 4 * static_cast<float>(k);
    for (const float side : {-1.0F, 1.0F}) {
      const double turns = side < 0 ? 0 : 0.5;
      add_instance(scene, rib, placed({at, 0, side * kSide}, turns));
      add_instance(scene, column, placed({at + 2, 0, side * kSide}, turns));
    }
    add_instance(scene, beam, placed({at, 0, 0}));
  }
  // Strips under the ceiling; the middle ones light the hall, the others only glow.
  for (int k = 0; k < 3; ++k) {
    const float at = -8 + 8 * static_cast<float>(k);
    for (const float side : {-2.6F, 2.6F}) {
      Mesh strip =
          make_box("ceiling strip", {at - 3, kHeight - 0.75F, side - 0.22F}, {at + 3, kHeight - 0.65F, side + 0.22F});
      add_object(scene, std::move(strip), k == 1 ? bright : glow);
    }
  }
}

}  // namespace traces::car
