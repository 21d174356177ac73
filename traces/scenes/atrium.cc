#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scene/scene.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/detail.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::atrium {
namespace {

// Dimensions of the court in metres; the origin is the middle of its floor. Columns form a rectangle of 18 x 7.2, with
// arcades of two storeys on all sides, galleries 3 deep around them, and the sky above.
constexpr float kHalfLength = 9, kHalfWidth = 3.6F, kGallery = 3;
constexpr int kLongBays = 6, kShortBays = 3;
constexpr float kLongBay = 3.0F, kShortBay = 2.4F;
constexpr float kWall = 0.5F;  ///< thickness of the wall of an arcade
constexpr float kSpring = 3.0F, kUpper = 5.0F, kUpperSpring = 7.3F, kTop = 9.4F;

/// Indices of the atrium's textures in Scene::textures.
enum Picture : std::uint32_t { kAshlar, kBrick, kFloor, kStone, kWood, kRedBanner, kBlueBanner, kCurtain };

/// Indices of the atrium's materials in Scene::materials.
struct Materials {
  std::uint32_t ashlar, brick, floor, stone, light_stone, wood, plaster, red, blue, curtain, iron, leaf, clay, soil,
      water, glow;
};

/// Calls visit(middle, inwards, width) for each bay of the arcades; `inwards` is the direction into the court.
template <class Visit>
void for_each_bay(Visit visit) {
  for (const float side : {-1.0F, 1.0F}) {
    for (int k = 0; k < kLongBays; ++k) {
      const float x = kLongBay * (static_cast<float>(k) + 0.5F) - kHalfLength;
      visit(glm::vec3(x, 0, side * kHalfWidth), glm::vec3(0, 0, -side), kLongBay);
    }
    for (int k = 0; k < kShortBays; ++k) {
      const float z = kShortBay * (static_cast<float>(k) + 0.5F) - kHalfWidth;
      visit(glm::vec3(side * kHalfLength, 0, z), glm::vec3(-side, 0, 0), kShortBay);
    }
  }
}

/// Returns the colour of a floor of slabs in two stones, with small dark squares at the corners.
glm::vec4 floor_slabs(float u, float v) {
  const float x = u * 4 - std::floor(u * 4), y = v * 4 - std::floor(v * 4);
  const auto i = static_cast<std::uint64_t>(u * 4), j = static_cast<std::uint64_t>(v * 4);
  const float corner = std::abs(std::abs(x - 0.5F) - 0.5F) + std::abs(std::abs(y - 0.5F) - 0.5F);
  const float edge = std::min(std::min(x, 1 - x), std::min(y, 1 - y));
  const float cloud = fractal_noise(u, v, 8, 5, 17);
  if (corner < 0.2F) return {glm::vec3(0.24F, 0.16F, 0.14F) * (0.8F + 0.5F * cloud), 1};
  if (edge < 0.012F || corner < 0.216F) return {0.38F, 0.34F, 0.30F, 1};
  const glm::vec3 slab = (i + j) % 2 == 0 ? glm::vec3(0.76F, 0.68F, 0.56F) : glm::vec3(0.66F, 0.55F, 0.44F);
  return {slab * (0.82F + 0.1F * random_unit(3, i, j) + 0.25F * (cloud - 0.4F)), 1};
}

/// Returns the colour of a woven banner: a border, a field and an eight-pointed star.
glm::vec4 banner_colour(float u, float v, const glm::vec3& ground) {
  const glm::vec3 gold(0.86F, 0.66F, 0.24F);
  const float weave =
      0.86F + 0.2F * random_unit(8, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 384));
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

glm::vec4 curtain_colour(float u, float v) {
  const float weave =
      0.85F + 0.2F * random_unit(9, static_cast<std::uint64_t>(u * 192), static_cast<std::uint64_t>(v * 192));
  const float row = v * 5 - std::floor(v * 5), x = u * 6 - std::floor(u * 6) - 0.5F;
  glm::vec3 c = glm::mix(glm::vec3(0.20F, 0.42F, 0.28F), glm::vec3(0.15F, 0.33F, 0.24F), fractal_noise(u, v, 8, 3, 5));
  if (row < 0.06F || (row > 0.1F && row < 0.13F)) c = {0.80F, 0.66F, 0.32F};
  if (std::abs(x) + std::abs(row - 0.56F) < 0.14F) c = {0.66F, 0.52F, 0.26F};
  return {c * weave, 1};
}

void add_room_textures(Scene& scene) {
  scene.textures = {
      brick_texture("ashlar", {0.87F, 0.79F, 0.65F}, {0.66F, 0.59F, 0.48F}, 4, 6, 41, 512),
      brick_texture("brick", {0.80F, 0.53F, 0.39F}, {0.76F, 0.70F, 0.62F}, 6, 14, 42, 512),
      paint_texture("floor slabs", 1024, 1024, floor_slabs),
      stone_texture("stone", {0.90F, 0.83F, 0.71F}, {0.68F, 0.60F, 0.49F}, 43, 512),
      wood_texture("oak", {0.44F, 0.28F, 0.16F}, {0.24F, 0.14F, 0.08F}, 44, 256),
      paint_texture("red banner", 256, 768,
                    [](float u, float v) {
                      return banner_colour(u, v, {0.66F, 0.10F, 0.09F});
                    }),
      paint_texture("blue banner", 256, 768,
                    [](float u, float v) {
                      return banner_colour(u, v, {0.10F, 0.20F, 0.48F});
                    }),
      paint_texture("curtain", 512, 512, curtain_colour),
  };
}

Materials add_materials(Scene& scene) {
  const auto with_picture = [&scene](const char* name, Picture picture, const glm::vec3& colour = glm::vec3(1),
                                     float mirror = 0) {
    return add_material(scene, make_textured(name, picture, colour, mirror));
  };
  Material glow = make_lamp("lantern", {0.99F, 0.80F, 0.48F});
  glow.casts_light = false;
  Materials materials{};
  materials.ashlar = with_picture("ashlar", kAshlar);
  materials.brick = with_picture("brick", kBrick);
  materials.floor = with_picture("polished floor", kFloor, glm::vec3(1), 0.14F);
  materials.stone = with_picture("stone", kStone);
  materials.light_stone = with_picture("light stone", kStone, glm::vec3(1.0F, 0.98F, 0.95F));
  materials.wood = with_picture("oak", kWood);
  materials.plaster = add_material(scene, make_paint("plaster", {0.80F, 0.73F, 0.62F}));
  materials.red = with_picture("red banner", kRedBanner);
  materials.blue = with_picture("blue banner", kBlueBanner);
  materials.curtain = with_picture("curtain", kCurtain);
  materials.iron = add_material(scene, make_paint("iron", {0.07F, 0.065F, 0.06F}));
  materials.leaf = add_material(scene, make_paint("leaves", {0.17F, 0.38F, 0.11F}));
  materials.clay = add_material(scene, make_paint("clay", {0.68F, 0.38F, 0.24F}));
  materials.soil = add_material(scene, make_paint("soil", {0.14F, 0.10F, 0.07F}));
  materials.water = add_material(scene, make_paint("water", {0.10F, 0.22F, 0.24F}, 0.45F));
  materials.glow = add_material(scene, glow);
  return materials;
}

/// Makes a column: Attic base, slightly swelling shaft, bell with two rings of leaves, abacus. `radius` is at its foot.
Mesh make_column(float height, float radius, const Detail& detail) {
  const std::uint32_t round = detail.cell_count(18, 6);
  const float r = radius;
  Mesh mesh = make_box("column", {-1.45F * r, 0, -1.45F * r}, {1.45F * r, 0.45F * r, 1.45F * r});
  const glm::vec2 base[] = {{1.3F * r, 0.45F * r},  {1.42F * r, 0.58F * r}, {1.3F * r, 0.72F * r},
                            {1.12F * r, 0.8F * r},  {1.14F * r, 0.9F * r},  {1.24F * r, 0.98F * r},
                            {1.14F * r, 1.08F * r}, {1.02F * r, 1.12F * r}, {r, 1.2F * r}};
  append_mesh(mesh, make_lathe("", detail.coarser_profile(base), round));
  const float neck = height - 2.3F * r;
  const glm::vec2 shaft[] = {{r, 1.2F * r}, {0.99F * r, 0.4F * neck}, {0.93F * r, 0.75F * neck}, {0.85F * r, neck}};
  append_mesh(mesh, make_lathe("", catmull_rom(detail.coarser_profile(shaft), detail.cell_count(2)), round));
  const glm::vec2 bell[] = {{0.85F * r, neck},
                            {0.98F * r, neck + 0.05F * r},
                            {0.98F * r, neck + 0.15F * r},
                            {0.86F * r, neck + 0.2F * r},
                            {0.9F * r, neck + 1.0F * r},
                            {1.15F * r, neck + 1.7F * r},
                            {1.3F * r, neck + 1.85F * r}};
  append_mesh(mesh, make_lathe("", detail.coarser_profile(bell), round));
  for (int ring = 0; ring < 2; ++ring) {
    for (int k = 0; k < 8; ++k) {
      const glm::vec2 way = circle_point((k + 0.5 * ring) / 8.0);
      const float y = neck + (0.2F + 0.65F * static_cast<float>(ring)) * r;
      add_leaf(mesh, {0.88F * r * way.x, y, 0.88F * r * way.y},
               glm::normalize(glm::vec3(0.35F * way.x, 1, 0.35F * way.y)), 1.05F * r, 0.42F * r, 0.22F,
               detail.cell_count(4, 2));
    }
  }
  append_mesh(mesh, make_box("", {-1.4F * r, neck + 1.85F * r, -1.4F * r}, {1.4F * r, neck + 2.1F * r, 1.4F * r}));
  append_mesh(mesh, make_box("", {-1.5F * r, neck + 2.1F * r, -1.5F * r}, {1.5F * r, height, 1.5F * r}));
  project_uvs(mesh, 0.8F);
  return mesh;
}

/// Makes a pier for a corner of the court, where two arcades meet.
Mesh make_pier(float height) {
  constexpr float a = 0.32F;
  Mesh mesh = make_box("pier", {-a, 0, -a}, {a, height, a});
  append_mesh(mesh, make_box("", {-a - 0.06F, 0, -a - 0.06F}, {a + 0.06F, 0.3F, a + 0.06F}));
  append_mesh(mesh, make_box("", {-a - 0.05F, height - 0.2F, -a - 0.05F}, {a + 0.05F, height, a + 0.05F}));
  project_uvs(mesh, 0.6F);
  return mesh;
}

void add_columns(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t low = add_mesh(scene, make_column(kSpring, 0.2F, detail), materials.stone);
  const std::uint32_t high = add_mesh(scene, make_column(kUpperSpring - kUpper, 0.155F, detail), materials.stone);
  const std::uint32_t low_pier = add_mesh(scene, make_pier(kUpper - 0.2F), materials.ashlar);
  const std::uint32_t high_pier = add_mesh(scene, make_pier(kTop - kUpper), materials.ashlar);
  for (const float side : {-1.0F, 1.0F}) {
    const auto add_pair = [&](const glm::vec3& at, bool is_pier) {
      add_instance(scene, is_pier ? low_pier : low, placement_at(at));
      add_instance(scene, is_pier ? high_pier : high, placement_at(at + glm::vec3(0, kUpper, 0)));
    };
    for (int k = 0; k <= kLongBays; ++k) {
      add_pair({kLongBay * static_cast<float>(k) - kHalfLength, 0, side * kHalfWidth}, k == 0 || k == kLongBays);
    }
    for (int k = 1; k < kShortBays; ++k)
      add_pair({side * kHalfLength, 0, kShortBay * static_cast<float>(k) - kHalfWidth}, false);
  }
}

void add_balustrades(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::vec2 shape[] = {{0.06F, 0.12F},  {0.06F, 0.16F}, {0.035F, 0.2F}, {0.075F, 0.34F}, {0.05F, 0.52F},
                             {0.032F, 0.64F}, {0.04F, 0.72F}, {0.06F, 0.76F}, {0.06F, 0.8F}};
  const Mesh baluster = make_lathe("", detail.coarser_profile(shape), detail.cell_count(8, 4));
  const auto make_bay = [&](float bay) {
    const float half = bay / 2 - 0.23F;
    Mesh mesh = make_box("balustrade", {-half, 0, -0.1F}, {half, 0.12F, 0.1F});
    append_mesh(mesh, make_box("", {-half, 0.8F, -0.09F}, {half, 0.86F, 0.09F}));
    append_mesh(mesh, make_box("", {-half, 0.86F, -0.12F}, {half, 0.94F, 0.12F}));
    const std::uint32_t count = std::min(detail.cell_count(bay > 2.7F ? 9 : 7, 4), bay > 2.7F ? 9U : 7U);
    for (std::uint32_t k = 0; k < count; ++k) {
      const float x = 2 * half * ((static_cast<float>(k) + 0.5F) / static_cast<float>(count) - 0.5F);
      append_mesh(mesh, transform_mesh(baluster, placement_at({x, 0, 0})));
    }
    project_uvs(mesh, 0.8F);
    return add_mesh(scene, std::move(mesh), materials.light_stone);
  };
  const std::uint32_t long_bay = make_bay(kLongBay), short_bay = make_bay(kShortBay);
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float width) {
    add_instance(scene, width > 2.7F ? long_bay : short_bay, wall_axes(middle + glm::vec3(0, kUpper, 0), inward));
  });
}

constexpr float kOuterX = kHalfLength + kGallery, kOuterZ = kHalfWidth + kGallery;

/// Makes the strip of an arch between two points (radius, z) of its cross-section.
Mesh make_arch_strip(const glm::vec2& from, const glm::vec2& to, std::uint32_t cells) {
  return make_surface("", cells, 1, [&](float s, float t) {
    const glm::vec2 ring = t < 0.5F ? from : to;
    const glm::vec2 p = ring.x * circle_point(s == 1 ? 0.5 : 0.5 * static_cast<double>(s));
    return glm::vec3(p, ring.y);
  });
}

/// Makes one bay of wall with a round arch, from the springing line (y = 0) upwards. Its face is at z = kWall / 2.
Mesh make_arch_wall(float width, float radius, float height, const Detail& detail) {
  const std::uint32_t cells = detail.cell_count(16, 4);
  constexpr float kHalf = kWall / 2;
  Mesh mesh;
  mesh.name = "arch wall";
  for (const float side : {-1.0F, 1.0F}) {
    Mesh face = make_surface("", cells, 1, [&](float s, float t) {
      const glm::vec2 p = radius * circle_point(s == 1 ? 0.5 : 0.5 * static_cast<double>(s));
      return glm::vec3(-side * p.x, t < 0.5F ? p.y : height, side * kHalf);
    });
    append_mesh(mesh, face);
    for (const float end : {-1.0F, 1.0F}) {
      const float inner = end * radius, outer = end * width / 2;
      const float left = std::min(inner, outer), wide = width / 2 - radius;
      if (side > 0) append_mesh(mesh, make_quad("", {left, 0, kHalf}, {wide, 0, 0}, {0, height, 0}, 1));
      if (side < 0) append_mesh(mesh, make_quad("", {left + wide, 0, -kHalf}, {-wide, 0, 0}, {0, height, 0}, 1));
    }
  }
  append_mesh(mesh, make_arch_strip({radius, kHalf}, {radius, -kHalf}, cells));
  for (const float end : {-1.0F, 1.0F}) {  // undersides, above the columns
    const float left = end < 0 ? -width / 2 : radius;
    append_mesh(mesh, make_quad("", {left, 0, -kHalf}, {width / 2 - radius, 0, 0}, {0, 0, kWall}, 1));
  }
  project_uvs(mesh, 0.42F);
  return mesh;
}

/// Makes the moulding around an arch on both faces of its wall, with keystones.
Mesh make_archivolt(float radius, const Detail& detail) {
  constexpr float z = kWall / 2;
  const glm::vec2 section[] = {{radius - 0.004F, z - 0.06F}, {radius - 0.004F, z + 0.06F}, {radius + 0.1F, z + 0.06F},
                               {radius + 0.12F, z + 0.035F}, {radius + 0.17F, z + 0.035F}, {radius + 0.19F, z - 0.01F}};
  const std::uint32_t cells = detail.cell_count(16, 4);
  Mesh mesh;
  mesh.name = "archivolt";
  const std::vector<glm::vec2> points = detail.coarser_profile(section);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Mesh strip = make_arch_strip(points[k + 1], points[k], cells);
    append_mesh(mesh, strip);
    append_mesh(mesh, transform_mesh(strip, placement_at(glm::vec3(0), 0.5)));
  }
  const glm::vec2 key[] = {
      {-0.09F, radius - 0.03F}, {0.09F, radius - 0.03F}, {0.13F, radius + 0.3F}, {-0.13F, radius + 0.3F}};
  append_mesh(mesh, transform_mesh(make_extrusion("", key, kWall + 0.18F), placement_at({0, 0, -kWall / 2 - 0.09F})));
  project_uvs(mesh, 0.6F);
  return mesh;
}

/// Makes a cornice along x, from -half to half, with its back at z = 0.
Mesh make_cornice(float half, std::span<const glm::vec2> outline) {
  const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {half, 0, 0, 1}};
  Mesh mesh = transform_mesh(make_extrusion("cornice", outline, 2 * half), along);
  project_uvs(mesh, 0.6F);
  return mesh;
}

void add_slabs(Scene& scene, std::uint32_t material, float low, float high, float rim) {
  // Four boards around the court; `rim` is how far they project into it.
  const float x = kHalfLength - rim, z = kHalfWidth - rim;
  const std::array<std::array<float, 4>, 4> areas = {
      {{-kOuterX, kOuterX, -kOuterZ, -z}, {-kOuterX, kOuterX, z, kOuterZ}, {-kOuterX, -x, -z, z}, {x, kOuterX, -z, z}}};
  for (const auto& [x0, x1, z0, z1] : areas) {
    Mesh slab = make_box("slab", {x0, low, z0}, {x1, high, z1});
    project_uvs(slab, 0.45F);
    add_object(scene, std::move(slab), material);
  }
}

void add_door(Scene& scene, const Materials& materials, const Detail& detail, const glm::mat4& wall) {
  const glm::vec2 leaf[] = {{0, 0}, {0, 0.05F}, {0.09F, 0.05F}, {0.11F, 0.025F}, {0.14F, 0.025F}, {0.18F, 0.045F}};
  Mesh door;
  door.name = "door";
  for (const float x : {-0.62F, 0.0F}) {
    for (const auto& [low, high] : {std::pair{0.0F, 1.0F}, std::pair{1.0F, 2.3F}}) {
      append_mesh(door,
                  transform_mesh(make_panel("", 0.62F, high - low, detail.coarser_profile(leaf), detail.cell_count(1)),
                                 wall * placement_at({x, low, 0})));
    }
  }
  project_uvs(door, 0.8F, true);
  add_object(scene, std::move(door), materials.wood);
  Mesh frame;
  frame.name = "door frame";
  for (const float x : {-0.82F, 0.62F}) append_mesh(frame, make_box("", {x, 0, 0}, {x + 0.2F, 2.3F, 0.12F}));
  append_mesh(frame, make_box("", {-0.92F, 2.3F, 0}, {0.92F, 2.52F, 0.15F}));
  append_mesh(frame, make_box("", {-0.98F, 2.52F, 0}, {0.98F, 2.6F, 0.22F}));
  frame = transform_mesh(std::move(frame), wall);
  project_uvs(frame, 0.6F);
  add_object(scene, std::move(frame), materials.stone);
}

void add_walls(Scene& scene, const Materials& materials, const Detail& detail) {
  Mesh floor =
      make_quad("floor", {-kOuterX, 0, -kOuterZ}, {0, 0, 2 * kOuterZ}, {2 * kOuterX, 0, 0}, detail.cell_count(12));
  project_uvs(floor, 0.25F);
  add_object(scene, std::move(floor), materials.floor);
  const auto add_outer = [&](const glm::vec3& origin, const glm::vec3& outward, float width) {
    Mesh wall = transform_mesh(make_quad("outer wall", glm::vec3(0), {width, 0, 0}, {0, kTop, 0}, detail.cell_count(8)),
                               wall_axes(origin, outward));
    project_uvs(wall, 0.7F);
    add_object(scene, std::move(wall), materials.brick);
  };
  add_outer({-kOuterX, 0, -kOuterZ}, {0, 0, 1}, 2 * kOuterX);
  add_outer({kOuterX, 0, kOuterZ}, {0, 0, -1}, 2 * kOuterX);
  add_outer({kOuterX, 0, -kOuterZ}, {-1, 0, 0}, 2 * kOuterZ);
  add_outer({-kOuterX, 0, kOuterZ}, {1, 0, 0}, 2 * kOuterZ);
  add_slabs(scene, materials.plaster, kUpper - 0.2F, kUpper - 0.001F, 0.25F);
  add_slabs(scene, materials.stone, kUpper - 0.001F, kUpper, 0.4F);
  add_slabs(scene, materials.wood, kTop, kTop + 0.25F, 0.7F);
  int count = 0;
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float) {
    const glm::vec3 foot = middle - (kGallery - 0.001F) * inward;
    for (const float y : {0.0F, kUpper}) {
      if (count++ % 3 != 1) add_door(scene, materials, detail, wall_axes(foot + glm::vec3(0, y, 0), inward));
    }
    // Beams below both ceilings.
    for (const float y : {kUpper - 0.2F, kTop}) {
      Mesh beam = transform_mesh(make_box("beam", {-0.1F, -0.2F, 0}, {0.1F, 0, kGallery - 0.2F}),
                                 wall_axes(foot + glm::vec3(0, y, 0), inward));
      project_uvs(beam, 0.8F);
      add_object(scene, std::move(beam), materials.wood);
    }
  });
}

void add_arcades(Scene& scene, const Materials& materials, const Detail& detail) {
  struct Kind {
    std::uint32_t wall, archivolt;
  };
  const auto make_kind = [&](float bay, float height) {
    const float radius = 0.5F * bay - 0.3F;
    return Kind{add_mesh(scene, make_arch_wall(bay, radius, height, detail), materials.ashlar),
                add_mesh(scene, make_archivolt(radius, detail), materials.light_stone)};
  };
  const Kind long_low = make_kind(kLongBay, kUpper - 0.2F - kSpring),
             short_low = make_kind(kShortBay, kUpper - 0.2F - kSpring);
  const Kind long_high = make_kind(kLongBay, kTop - kUpperSpring),
             short_high = make_kind(kShortBay, kTop - kUpperSpring);
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float width) {
    const bool is_long = width > 2.7F;
    const Kind& low = is_long ? long_low : short_low;
    const Kind& high = is_long ? long_high : short_high;
    for (const auto& [kind, y] : {std::pair{low, kSpring}, std::pair{high, kUpperSpring}}) {
      const glm::mat4 at = wall_axes(middle + glm::vec3(0, y, 0), inward);
      add_instance(scene, kind.wall, at);
      add_instance(scene, kind.archivolt, at);
    }
  });
  const glm::vec2 string_course[] = {{0, 0},         {0.04F, 0},    {0.06F, 0.05F}, {0.12F, 0.08F},
                                     {0.15F, 0.15F}, {0.15F, 0.2F}, {0, 0.2F}};
  const glm::vec2 crown[] = {{0, 0},         {0.06F, 0},     {0.1F, 0.08F},  {0.2F, 0.12F},
                             {0.26F, 0.24F}, {0.32F, 0.26F}, {0.32F, 0.34F}, {0, 0.34F}};
  Mesh dentils;
  dentils.name = "dentils";
  for (const auto& [outline, y] :
       {std::pair<std::span<const glm::vec2>, float>{string_course, kUpper - 0.21F}, {crown, kTop - 0.35F}}) {
    for (const float side : {-1.0F, 1.0F}) {
      const glm::mat4 long_side = wall_axes({0, y, side * (kHalfWidth - kWall / 2)}, {0, 0, -side});
      const glm::mat4 short_side = wall_axes({side * (kHalfLength - kWall / 2), y, 0}, {-side, 0, 0});
      add_object(scene, transform_mesh(make_cornice(kHalfLength - kWall / 2, outline), long_side),
                 materials.light_stone);
      add_object(scene, transform_mesh(make_cornice(kHalfWidth - kWall / 2, outline), short_side),
                 materials.light_stone);
      if (y < kTop - 1) continue;
      const Mesh dentil = make_box("", {-0.07F, -0.16F, 0}, {0.07F, 0, 0.1F});
      for (int k = -21; k <= 21; ++k)
        append_mesh(dentils, transform_mesh(dentil, long_side * placement_at({0.4F * static_cast<float>(k), 0, 0})));
      for (int k = -8; k <= 8; ++k)
        append_mesh(dentils, transform_mesh(dentil, short_side * placement_at({0.4F * static_cast<float>(k), 0, 0})));
    }
  }
  add_object(scene, std::move(dentils), materials.light_stone);
}

void upright_picture(Mesh& mesh) {
  for (glm::vec2& uv : mesh.uvs) uv.y = 1 - uv.y;
}

void add_cloth(Scene& scene, const Materials& materials, const Detail& detail) {
  // Banners over the balustrades, at every other column.
  constexpr float kWide = 0.95F, kTall = 3.1F;
  Mesh cloth = make_surface("banner", detail.cell_count(10, 4), detail.cell_count(18, 6), [](float s, float t) {
    const float down = 1 - t;
    const float wave = 0.05F * down * sin_turns(static_cast<double>(0.8F * s + 1.1F * t)) +
                       0.025F * down * sin_turns(static_cast<double>(2.0F * s - 0.7F * t));
    const float point = 0.22F * down * down * (2 * s - 1) * (2 * s - 1);
    return glm::vec3((s - 0.5F) * kWide, kTall * (t - 1) + point, wave);
  });
  upright_picture(cloth);
  const std::uint32_t red = add_mesh(scene, cloth, materials.red),
                      blue = add_mesh(scene, std::move(cloth), materials.blue);
  const std::uint32_t rod = add_mesh(scene,
                                     transform_mesh(make_cylinder("banner rod", 0.022F, 1.15F, detail.cell_count(8, 4)),
                                                    rotation_about({0.575F, 0, 0}, {0, 0, 1}, 0.25)),
                                     materials.iron);
  const std::uint32_t arm = add_mesh(scene,
                                     transform_mesh(make_cylinder("banner arm", 0.018F, 0.45F, detail.cell_count(8, 4)),
                                                    rotation_about({0, 0, -0.42F}, {1, 0, 0}, 0.25)),
                                     materials.iron);
  const auto add_banner = [&](const glm::vec3& at, const glm::vec3& inward, std::uint32_t which) {
    const glm::mat4 to_world = wall_axes(at, inward);
    add_instance(scene, which, to_world);
    add_instance(scene, rod, to_world);
    add_instance(scene, arm, to_world);
  };
  for (int k = 1; k < kLongBays; k += 2) {
    const float x = kLongBay * static_cast<float>(k) - kHalfLength;
    for (const float side : {-1.0F, 1.0F}) {
      add_banner({x, kUpper + 1.1F, side * (kHalfWidth - 0.55F)}, {0, 0, -side}, (k / 2) % 2 == 0 ? red : blue);
    }
  }
  // Curtains in some of the lower arches.
  const float half = kLongBay / 2 - 0.24F;
  Mesh curtain =
      make_curtain("curtain", half, 2.62F, 5, 0.07F, detail.cell_count(30, 10), detail.cell_count(10, 3), 77);
  upright_picture(curtain);
  const std::uint32_t curtain_mesh = add_mesh(scene, std::move(curtain), materials.curtain);
  const std::uint32_t pole =
      add_mesh(scene,
               transform_mesh(make_cylinder("curtain pole", 0.025F, 2 * half, detail.cell_count(8, 4)),
                              rotation_about({half, 0, 0}, {0, 0, 1}, 0.25)),
               materials.iron);
  for (const auto& [bay, side, both] : {std::tuple{1, -1.0F, true},
                                        {3, -1.0F, false},
                                        {4, -1.0F, true},
                                        {0, 1.0F, false},
                                        {3, 1.0F, true},
                                        {5, 1.0F, true}}) {
    const float x = kLongBay * (static_cast<float>(bay) + 0.5F) - kHalfLength;
    const glm::mat4 at = wall_axes({x, 0.12F, side * kHalfWidth}, {0, 0, -side});
    add_instance(scene, pole, at * placement_at({0, 2.62F, 0}));
    add_instance(scene, curtain_mesh, at * placement_at({-half, 0, 0}, 0, {both ? 0.75F : 0.95F, 1, 1}));
    if (both) add_instance(scene, curtain_mesh, at * placement_at({0.25F * half, 0, 0}, 0, {0.75F, 1, 1}));
  }
}

void add_fountain(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::mat4 at = placement_at({2.6F, 0, 0});
  const auto add_lathe = [&](const char* name, std::span<const glm::vec2> profile, std::uint32_t segments,
                             std::uint32_t material) {
    Mesh mesh = make_lathe(name, detail.coarser_profile(profile), segments);
    project_uvs(mesh, 0.6F);
    add_object(scene, transform_mesh(std::move(mesh), at), material);
  };
  const std::uint32_t round = detail.cell_count(28, 12);
  const glm::vec2 step[] = {{1.75F, 0}, {1.75F, 0.12F}, {1.3F, 0.12F}};
  const glm::vec2 rim[] = {{1.35F, 0.12F}, {1.35F, 0.2F},  {1.25F, 0.24F}, {1.25F, 0.5F},
                           {1.36F, 0.54F}, {1.36F, 0.62F}, {1.12F, 0.62F}, {1.12F, 0.3F}};
  const glm::vec2 pool[] = {{1.13F, 0.5F}, {0, 0.5F}};
  const glm::vec2 foot[] = {{0.3F, 0.4F},   {0.3F, 0.55F},  {0.16F, 0.65F}, {0.13F, 0.8F},
                            {0.2F, 0.95F},  {0.12F, 1.1F},  {0.14F, 1.2F},  {0.45F, 1.3F},
                            {0.62F, 1.42F}, {0.64F, 1.46F}, {0.58F, 1.44F}, {0.4F, 1.36F}};
  const glm::vec2 upper_pool[] = {{0.56F, 1.42F}, {0, 1.42F}};
  const glm::vec2 finial[] = {{0.07F, 1.36F}, {0.06F, 1.55F}, {0.12F, 1.66F},
                              {0.13F, 1.74F}, {0.05F, 1.86F}, {0, 1.9F}};
  add_lathe("fountain step", step, 8, materials.light_stone);
  add_lathe("fountain rim", rim, 8, materials.stone);
  add_lathe("fountain water", pool, 8, materials.water);
  add_lathe("fountain bowl", catmull_rom(foot, detail.cell_count(2)), round, materials.stone);
  add_lathe("fountain bowl's water", upper_pool, round, materials.water);
  add_lathe("finial", catmull_rom(finial, detail.cell_count(2)), round, materials.light_stone);
}

void add_plants(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::vec2 pot[] = {{0, 0},         {0.2F, 0},     {0.24F, 0.04F}, {0.33F, 0.3F},  {0.3F, 0.5F},
                           {0.27F, 0.55F}, {0.33F, 0.6F}, {0.34F, 0.65F}, {0.28F, 0.65F}, {0.25F, 0.58F}};
  const glm::vec2 ground[] = {{0.26F, 0.59F}, {0, 0.62F}};
  const std::uint32_t round = detail.cell_count(22, 8);
  const std::uint32_t pot_mesh = add_mesh(scene, make_lathe("pot", detail.coarser_profile(pot), round), materials.clay);
  const std::uint32_t soil_mesh =
      add_mesh(scene, make_lathe("soil", detail.coarser_profile(ground), round), materials.soil);
  const glm::vec3 positions[] = {{-5.9F, 0, 2.75F}, {-6.1F, 0, -2.75F}, {-0.2F, 0, -2.75F},
                                 {0.1F, 0, 2.75F},  {5.9F, 0, -2.75F},  {6.1F, 0, 2.75F}};
  std::uint32_t seed = 90;
  for (const glm::vec3& at : positions) {
    ++seed;
    add_instance(scene, pot_mesh, placement_at(at));
    add_instance(scene, soil_mesh, placement_at(at));
    Mesh foliage;
    foliage.name = "foliage";
    const std::uint32_t count = detail.piece_count(70, 12);
    for (std::uint32_t k = 0; k < count; ++k) {
      const float age = (static_cast<float>(k) + 0.5F) / static_cast<float>(count);
      const glm::vec2 way = circle_point(static_cast<double>(0.382F * static_cast<float>(k)));
      const float rise = 2.4F - 2.0F * age + 0.5F * random_unit(seed, k);
      const float length = random_between(0.7F, 1.0F, seed, k, 1) * (1.15F - 0.3F * age);
      add_leaf(foliage, at + glm::vec3(0.1F * way.x, 0.6F, 0.1F * way.y), glm::normalize(glm::vec3(way.x, rise, way.y)),
               length, 0.075F, 0.25F + 0.5F * age, detail.cell_count(6, 3));
    }
    add_object(scene, std::move(foliage), materials.leaf);
  }
}

void add_lanterns(Scene& scene, const Materials& materials, const Detail& detail) {
  const std::uint32_t round = detail.cell_count(10, 6);
  const glm::vec2 hood[] = {{0.13F, 0.28F}, {0.14F, 0.3F},   {0.05F, 0.38F},
                            {0.02F, 0.42F}, {0.012F, 0.46F}, {0.012F, 1.05F}};
  const glm::vec2 base[] = {{0, -0.05F}, {0.03F, -0.02F}, {0.11F, 0}, {0.11F, 0.03F}, {0, 0.03F}};
  Mesh frame = make_lathe("lantern", detail.coarser_profile(hood), round);
  append_mesh(frame, make_lathe("", detail.coarser_profile(base), round));
  for (int k = 0; k < 6; ++k) {
    const glm::vec2 p = circle_point(k / 6.0);
    append_mesh(frame, make_tube("",
                                 std::array{glm::vec3(0.105F * p.x, 0.02F, 0.105F * p.y),
                                            glm::vec3(0.125F * p.x, 0.29F, 0.125F * p.y)},
                                 std::array{0.006F}, 4));
  }
  const glm::vec2 flame[] = {{0.05F, 0.03F}, {0.075F, 0.12F}, {0.06F, 0.22F}, {0, 0.27F}};
  const std::uint32_t frame_mesh = add_mesh(scene, std::move(frame), materials.iron);
  const std::uint32_t flame_mesh = add_mesh(
      scene, make_lathe("lantern's light", catmull_rom(detail.coarser_profile(flame), 2), round), materials.glow);
  int count = 0;
  for_each_bay([&](const glm::vec3& middle, const glm::vec3& inward, float) {
    if (count++ % 2 == 0) return;
    const glm::mat4 at = placement_at(middle - 1.5F * inward + glm::vec3(0, kUpper - 0.4F - 1.05F, 0));
    add_instance(scene, frame_mesh, at);
    add_instance(scene, flame_mesh, at);
  });
}

}  // namespace
}  // namespace traces::atrium

namespace traces {
namespace {

using namespace atrium;

Scene furnish_court(const Detail& detail) {
  Scene scene;
  scene.name = "atrium";
  scene.background = {0.50F, 0.68F, 0.92F};
  const Materials materials = add_materials(scene);
  add_walls(scene, materials, detail);
  add_arcades(scene, materials, detail);
  add_columns(scene, materials, detail);
  add_balustrades(scene, materials, detail);
  add_cloth(scene, materials, detail);
  add_fountain(scene, materials, detail);
  add_plants(scene, materials, detail);
  add_lanterns(scene, materials, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("court", {-8.3F, 1.8F, 1.9F}, {1.5F, 3.3F, -0.9F}, 0.98F));
  scene.cameras.push_back(look_at("gallery", {-7.6F, 6.75F, 4.9F}, {3.0F, 4.2F, -2.5F}, 0.9F));
  scene.cameras.push_back(look_at("arcade", {-10.6F, 1.75F, -5.3F}, {2.0F, 1.9F, -3.9F}, 0.85F));
  const ViewKey keys[] = {{0, {-8.3F, 1.8F, 1.9F}, {1.5F, 3.3F, -0.9F}}, {5, {-4.5F, 1.8F, 1.9F}, {4, 3.0F, -1.0F}},
                          {10, {-0.5F, 2.6F, 1.8F}, {6, 3.2F, -2.2F}},   {15, {3.2F, 4.4F, 1.0F}, {8, 4.6F, -3.0F}},
                          {20, {5.6F, 6.2F, 0.2F}, {0.5F, 4.5F, -3.6F}}, {25, {4.2F, 6.8F, 0.8F}, {-5, 3.2F, -1.5F}}};
  add_camera_path(scene, "path", keys, 0.98F);
}

}  // namespace

/// Builds a court with arcades on two storeys, like Marko Dabrovic's and Crytek's atrium of Sponza. The scene has at
/// least a quarter of its standard number of triangles, because it has many different parts.
Scene build_atrium(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 66'000;
  Scene scene = build_to_size(options.triangles_or_default(kClass), furnish_court);
  add_room_textures(scene);
  add_cameras(scene);
  Light sun;
  sun.kind = Light::Kind::kDirectional;
  sun.direction = glm::normalize(glm::vec3(0.34F, -1, -0.36F));
  sun.intensity = {1.0F, 0.93F, 0.80F};
  scene.lights.push_back(sun);
  // Lights in place of the light that the sunlit wall and floor reflect into the galleries.
  for (const float x : {-4.6F, 5.2F}) {
    Light bounce;
    bounce.position = {x, 3.2F, -0.6F};
    bounce.intensity = {1.5F, 1.35F, 1.1F};
    scene.lights.push_back(bounce);
  }
  finish_scene(scene, {0.27F, 0.29F, 0.33F});
  return scene;
}

}  // namespace traces
