#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::bathroom {
namespace {

glm::vec4 marble_colour(float u, float v) {
  const float bend = fractal_noise(u, v, 4, 5, 3);
  const float vein = std::abs(sin_turns(static_cast<double>(2 * u + v + 2.2F * bend)));
  const float thin = vein < 0.12F ? 1 - vein / 0.12F : 0.0F;
  const glm::vec3 ground =
      glm::mix(glm::vec3(0.80F, 0.79F, 0.77F), glm::vec3(0.90F, 0.895F, 0.88F), fractal_noise(u, v, 9, 3, 8));
  return {glm::mix(ground, glm::vec3(0.52F, 0.52F, 0.54F), 0.7F * thin * bend), 1};
}

glm::vec4 stripes_colour(float u, float v) {
  const float row = v * 9 - std::floor(v * 9);
  const float loop =
      0.8F + 0.3F * random_unit(4, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 128));
  const glm::vec3 ink = row < 0.45F ? glm::vec3(0.16F, 0.36F, 0.52F) : glm::vec3(0.87F, 0.86F, 0.82F);
  return {ink * loop, 1};
}

glm::vec4 terry_colour(float u, float v) {
  const float loop =
      0.78F + 0.3F * random_unit(5, static_cast<std::uint64_t>(u * 128), static_cast<std::uint64_t>(v * 128));
  return {glm::vec3(0.93F, 0.72F, 0.60F) * loop * (0.92F + 0.12F * fractal_noise(u, v, 8, 3, 6)), 1};
}

/// Returns the colour of a bottle's label; u runs around the bottle.
glm::vec4 label_colour(float u, float v) {
  glm::vec3 c(0.93F, 0.92F, 0.86F);
  const float x = u * 2 - std::floor(u * 2);
  if (v > 0.3F && v < 0.72F && x > 0.15F && x < 0.85F) {
    c = {0.95F, 0.95F, 0.93F};
    if (v < 0.44F) c = {0.22F, 0.42F, 0.38F};
    const auto row = static_cast<std::uint64_t>(v * 48);
    if (v > 0.48F && v < 0.68F && row % 2 == 0 && x > 0.22F && x < 0.6F + 0.2F * random_unit(6, row))
      c = glm::vec3(0.3F);
  }
  return {c, 1};
}

}  // namespace

void add_room_textures(Scene& scene) {
  scene.textures = {paint_texture("marble", 512, 512, marble_colour),
                    wood_texture("oak", {0.74F, 0.56F, 0.36F}, {0.55F, 0.37F, 0.20F}, 14, 512),
                    paint_texture("terry", 256, 256, terry_colour), paint_texture("stripes", 256, 256, stripes_colour),
                    paint_texture("label", 256, 256, label_colour)};
}

Materials add_materials(Scene& scene) {
  const auto with_paint = [&scene](const char* name, const glm::vec3& colour, float mirror = 0) {
    return add_material(scene, make_paint(name, colour, mirror));
  };
  const auto with_picture = [&scene](const char* name, Picture picture, float mirror = 0) {
    return add_material(scene, make_textured(name, picture, glm::vec3(1), mirror));
  };
  Material ceiling = make_paint("ceiling", {0.86F, 0.86F, 0.85F});
  ceiling.emission = {0.3F, 0.295F, 0.285F};  // replaces light that the room reflects to the ceiling
  Material bulb = make_lamp("bulb", {0.99F, 0.95F, 0.86F});
  ceiling.casts_light = bulb.casts_light = false;
  Materials materials{};
  materials.tile = with_paint("white tile", {0.80F, 0.83F, 0.82F}, 0.05F);
  materials.accent = with_paint("teal tile", {0.10F, 0.36F, 0.38F}, 0.07F);
  materials.grout = with_paint("grout", {0.60F, 0.60F, 0.58F});
  materials.floor = with_picture("marble floor", kMarble);
  materials.wall = with_paint("wall paint", {0.78F, 0.83F, 0.80F});
  materials.ceiling = add_material(scene, ceiling);
  materials.enamel = with_paint("enamel", {0.90F, 0.90F, 0.89F}, 0.05F);
  materials.chrome = add_material(scene, make_metal("chrome", {0.90F, 0.91F, 0.93F}, 0.82F));
  materials.mirror = add_material(scene, make_metal("mirror", glm::vec3(0.93F), 0.95F));
  materials.glass = add_material(scene, make_glass("shower screen", {0.94F, 0.98F, 0.965F}, 1.0F));
  materials.oak = with_picture("oak", kOak);
  materials.stone = with_picture("marble top", kMarble, 0.05F);
  materials.white = with_paint("white lacquer", {0.88F, 0.88F, 0.87F});
  materials.towel = with_picture("terry towel", kTerry);
  materials.striped = with_picture("striped towel", kStripes);
  materials.mat = with_paint("bath mat", {0.20F, 0.42F, 0.48F});
  materials.bristle = with_paint("bristles", {0.86F, 0.82F, 0.70F});
  materials.wire = with_paint("black wire", {0.06F, 0.06F, 0.065F});
  materials.bottle = with_picture("labelled bottle", kLabel);
  materials.blue = with_paint("blue plastic", {0.10F, 0.30F, 0.62F});
  materials.green = with_paint("green plastic", {0.22F, 0.52F, 0.26F});
  materials.amber = with_paint("amber soap", {0.80F, 0.42F, 0.10F}, 0.06F);
  materials.rose = with_paint("rose", {0.82F, 0.34F, 0.42F});
  materials.duck = with_paint("rubber duck", {0.95F, 0.76F, 0.08F});
  materials.beak = with_paint("beak", {0.90F, 0.36F, 0.06F});
  materials.black = with_paint("black", glm::vec3(0.03F));
  materials.leaf = with_paint("leaves", {0.16F, 0.42F, 0.13F});
  materials.lamp = add_material(scene, bulb);
  materials.water = add_material(scene, make_glass("clear glass", glm::vec3(1), 1.4F));
  return materials;
}

namespace {

constexpr float kTileWidth = 0.2F, kTileHeight = 0.1F, kJoint = 0.003F, kTiled = 2.1F;
constexpr int kAccentRow = 12;

/// Makes tiles in running bond on a wall, from `left` to `right` in the wall's coordinates, cut at both ends. If
/// `accent`, makes only the accent row, otherwise only the other rows.
Mesh make_tiles(float left, float right, float top, bool accent, const Detail& detail) {
  const glm::vec2 rings[] = {{0, 0.002F}, {0, 0.006F}, {0.004F, 0.0085F}, {0.014F, 0.01F}};
  Mesh mesh;
  mesh.name = accent ? "accent tiles" : "wall tiles";
  for (int row = 0; kTileHeight * (static_cast<float>(row) + 0.5F) < top; ++row) {
    if ((row == kAccentRow) != accent) continue;
    float x = left - (row % 2 == 0 ? 0.0F : 0.5F * kTileWidth);
    for (; x < right - 1e-4F; x += kTileWidth) {
      const float from = std::max(x, left) + 0.5F * kJoint, to = std::min(x + kTileWidth, right) - 0.5F * kJoint;
      if (to - from < 0.03F) continue;
      const Mesh tile =
          make_panel("", to - from, kTileHeight - kJoint, detail.coarser_profile(rings), detail.cell_count(1));
      append_mesh(mesh,
                  transform_mesh(tile, placement_at({from, kTileHeight * static_cast<float>(row) + 0.5F * kJoint, 0})));
    }
  }
  return mesh;
}

void add_tiled_wall(Scene& scene, const Materials& materials, const Detail& detail, const glm::mat4& wall, float left,
                    float right) {
  add_object(scene, transform_mesh(make_tiles(left, right, kTiled, false, detail), wall), materials.tile);
  add_object(scene, transform_mesh(make_tiles(left, right, kTiled, true, detail), wall), materials.accent);
  const Mesh grout = make_quad("grout", {left, 0, 0.004F}, {right - left, 0, 0}, {0, kTiled, 0}, detail.cell_count(4));
  add_object(scene, transform_mesh(grout, wall), materials.grout);
  Mesh trim =
      make_rounded_box("trim", {left, kTiled, 0}, {right, kTiled + 0.035F, 0.022F}, 0.009F, detail.cell_count(3));
  add_object(scene, transform_mesh(std::move(trim), wall), materials.accent);
  const Mesh paint =
      make_quad("wall", {left, kTiled, 0}, {right - left, 0, 0}, {0, kHeight - kTiled, 0}, detail.cell_count(6));
  add_object(scene, transform_mesh(paint, wall), materials.wall);
}

void add_floor(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float kRadius = 0.058F, kAcross = 0.866025F * 2 * kRadius;
  const glm::vec2 profile[] = {
      {kRadius - 0.0015F, 0}, {kRadius - 0.0015F, 0.002F}, {kRadius - 0.004F, 0.004F}, {0, 0.004F}};
  const Mesh tile = make_lathe("", detail.coarser_profile(profile), 6);
  Mesh floor;
  floor.name = "floor tiles";
  for (int row = 0; row < 36; ++row) {
    for (int k = 0; k < 42; ++k) {
      const float z = -kHalfWidth + kAcross * (static_cast<float>(row) + (k % 2 == 0 ? 0.0F : 0.5F));
      const float x = -kHalfLength + 1.5F * kRadius * static_cast<float>(k);
      if (z > kHalfWidth + kRadius || x > kHalfLength + kRadius) continue;
      append_mesh(floor, transform_mesh(tile, placement_at({x, 0, z})));
    }
  }
  project_uvs(floor, 0.7F);
  add_object(scene, std::move(floor), materials.floor);
  add_object(scene,
             make_quad("floor grout", {-kHalfLength, 0.0022F, -kHalfWidth}, {0, 0, 2 * kHalfWidth},
                       {2 * kHalfLength, 0, 0}, detail.cell_count(4)),
             materials.grout);
}

void add_door(Scene& scene, const Materials& materials, const Detail& detail, const glm::mat4& wall, float left) {
  constexpr float kWidth = 0.84F, kTall = 2.06F;
  const glm::vec2 field[] = {{0, 0}, {0, 0.018F}, {0.1F, 0.018F}, {0.11F, 0.006F}};
  Mesh door;
  door.name = "door";
  for (const auto& [low, high] : {std::pair{0.01F, 0.98F}, std::pair{0.98F, kTall}}) {
    append_mesh(door,
                transform_mesh(make_panel("", kWidth, high - low, detail.coarser_profile(field), detail.cell_count(3)),
                               placement_at({left, low, 0})));
  }
  for (const float x : {left - 0.09F, left + kWidth})
    append_mesh(door, make_box("", {x, 0, 0}, {x + 0.09F, kTall + 0.09F, 0.035F}));
  append_mesh(door, make_box("", {left, kTall, 0}, {left + kWidth, kTall + 0.09F, 0.035F}));
  door = transform_mesh(std::move(door), wall);
  project_uvs(door, 0.9F, true);
  add_object(scene, std::move(door), materials.oak);
  const glm::vec3 grip[] = {{left + 0.78F, 1.02F, 0.01F},
                            {left + 0.78F, 1.02F, 0.06F},
                            {left + 0.74F, 1.02F, 0.07F},
                            {left + 0.66F, 1.02F, 0.065F}};
  Mesh handle = make_tube("door handle", catmull_rom(grip, detail.cell_count(6, 2)), std::array{0.009F},
                          detail.cell_count(10, 5));
  add_object(scene, transform_mesh(std::move(handle), wall), materials.chrome);
}

}  // namespace

void add_walls(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float x = kHalfLength, z = kHalfWidth;
  add_tiled_wall(scene, materials, detail, wall_axes({-x, 0, -z}, {0, 0, 1}), 0, 2 * x);
  add_tiled_wall(scene, materials, detail, wall_axes({x, 0, -z}, {-1, 0, 0}), 0, 2 * z);
  add_tiled_wall(scene, materials, detail, wall_axes({-x, 0, z}, {1, 0, 0}), 0, 2 * z);
  const glm::mat4 front = wall_axes({x, 0, z}, {0, 0, -1});
  constexpr float kDoorLeft = 0.7F, kDoorRight = kDoorLeft + 0.84F + 0.09F;
  add_tiled_wall(scene, materials, detail, front, 0, kDoorLeft - 0.09F);
  add_tiled_wall(scene, materials, detail, front, kDoorRight, 2 * x);
  add_door(scene, materials, detail, front, kDoorLeft);
  add_object(scene,
             transform_mesh(make_quad("wall above the door", {kDoorLeft - 0.09F, 2.1F, 0}, {1.02F, 0, 0},
                                      {0, kHeight - 2.1F, 0}, 2),
                            front),
             materials.wall);
  add_floor(scene, materials, detail);
  add_object(scene, make_quad("ceiling", {-x, kHeight, -z}, {2 * x, 0, 0}, {0, 0, 2 * z}, detail.cell_count(8)),
             materials.ceiling);
  const glm::vec2 bowl[] = {{0, -0.12F}, {0.12F, -0.105F}, {0.18F, -0.07F}, {0.2F, -0.02F}};
  const glm::mat4 under_ceiling = placement_at({-0.3F, kHeight, 0.25F});
  add_object(
      scene,
      transform_mesh(make_lathe("ceiling lamp", catmull_rom(detail.coarser_profile(bowl), detail.cell_count(4, 2)),
                                detail.cell_count(36, 12)),
                     under_ceiling),
      materials.lamp);
  const glm::vec2 ring[] = {{0.2F, -0.03F}, {0.215F, -0.03F}, {0.215F, 0}};
  add_object(
      scene,
      transform_mesh(make_lathe("lamp ring", detail.coarser_profile(ring), detail.cell_count(36, 12)), under_ceiling),
      materials.chrome);
}

}  // namespace traces::bathroom

namespace traces {
namespace {

using namespace bathroom;

Scene furnish_room(const Detail& detail) {
  Scene scene;
  scene.name = "bathroom";
  scene.background = glm::vec3(0.3F);
  const Materials materials = add_materials(scene);
  add_walls(scene, materials, detail);
  add_tub(scene, materials, detail);
  add_vanity(scene, materials, detail);
  add_basin(scene, materials, detail);
  add_mirror(scene, materials, detail);
  add_toilet(scene, materials, detail);
  add_shower(scene, materials, detail);
  add_towels(scene, materials, detail);
  add_mat(scene, materials, detail);
  add_baskets(scene, materials, detail);
  add_toiletries(scene, materials, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("door", {-0.05F, 1.52F, 1.38F}, {0, 0.9F, -1.2F}, 0.93F));
  scene.cameras.push_back(look_at("basin", {0.45F, 1.38F, -0.3F}, {1.05F, 1.1F, -1.4F}, 0.8F));
  scene.cameras.push_back(look_at("shower", {-0.5F, 1.4F, -0.85F}, {-1.7F, 1.1F, -1.12F}, 0.9F));
  const ViewKey keys[] = {{0, {-0.05F, 1.52F, 1.3F}, {0, 0.9F, -1.2F}},
                          {4, {-0.6F, 1.4F, 0.7F}, {0.7F, 1.0F, -1.3F}},
                          {8, {0.1F, 1.4F, 0.0F}, {1.0F, 1.15F, -1.4F}},
                          {12, {0.5F, 1.35F, 0.1F}, {-0.4F, 0.9F, -1.2F}},
                          {16, {0.2F, 1.3F, 0.3F}, {-1.4F, 0.9F, -1.0F}}};
  add_camera_path(scene, "path", keys, 0.9F);
}

void add_light(Scene& scene, const glm::vec3& position, const glm::vec3& intensity) {
  Light light;
  light.position = position;
  light.intensity = intensity;
  scene.lights.push_back(light);
}

}  // namespace

/// Builds a bathroom: mirrors and chrome, a glass screen, many parts thinner than a pixel (hose, rails, wires,
/// bristles).
Scene build_bathroom(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 270'000;
  Scene scene = build_to_size(options.triangles_or_default(kClass), furnish_room);
  add_room_textures(scene);
  add_cameras(scene);
  add_light(scene, {-0.3F, kHeight - 0.3F, 0.25F}, {1, 0.96F, 0.9F});
  add_light(scene, {1.0F, 2.12F, -1.12F}, {0.4F, 0.37F, 0.32F});
  add_light(scene, {-1.0F, kHeight - 0.15F, -1.0F}, {0.4F, 0.39F, 0.37F});  // between shower screen and wall
  finish_scene(scene, {0.28F, 0.285F, 0.29F});
  return scene;
}

}  // namespace traces
