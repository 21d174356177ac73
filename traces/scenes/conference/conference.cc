#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "traces/scene/cameras.h"
#include "traces/scenes/builtin.h"
#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/motion.h"
#include "traces/scenes/modelling/patterns.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::conference {
namespace {

/// Returns the colour of a carpet: loops of wool with small diamonds in rows.
glm::vec4 carpet_colour(float u, float v) {
  const float x = u * 8 - std::floor(u * 8) - 0.5F, y = v * 8 - std::floor(v * 8) - 0.5F;
  const float diamond = std::abs(x) + std::abs(y);
  const float loop = random_unit(1, static_cast<std::uint64_t>(u * 256), static_cast<std::uint64_t>(v * 256));
  glm::vec3 wool =
      glm::mix(glm::vec3(0.29F, 0.32F, 0.40F), glm::vec3(0.36F, 0.40F, 0.47F), fractal_noise(u, v, 8, 4, 2));
  if (diamond < 0.12F) wool = {0.62F, 0.56F, 0.44F};
  if (diamond > 0.44F && diamond < 0.5F) wool = {0.44F, 0.45F, 0.48F};
  return {wool * (0.8F + 0.35F * loop), 1};
}

glm::vec4 chart_colour(float u, float v) {
  const glm::vec3 ink(0.15F, 0.2F, 0.3F);
  glm::vec3 c = glm::mix(glm::vec3(0.97F), glm::vec3(0.88F, 0.93F, 0.98F), v);
  if (v < 0.13F) {
    c = {0.13F, 0.29F, 0.5F};
    const bool letters = v > 0.045F && v < 0.09F && u > 0.06F && u < 0.62F;
    if (letters && random_unit(7, static_cast<std::uint64_t>(u * 90)) > 0.3F) c = glm::vec3(0.95F);
  } else if (u > 0.07F && u < 0.93F && v > 0.2F && v < 0.9F) {
    const float x = (u - 0.1F) / 0.8F * 9, y = (0.85F - v) / 0.6F;
    const float bar =
        0.25F + 0.07F * std::floor(x) + 0.22F * random_unit(5, static_cast<std::uint64_t>(std::max(x, 0.0F)));
    const float inside = x - std::floor(x);
    if (std::abs(y * 5 - std::floor(y * 5 + 0.5F)) < 0.02F) c *= 0.8F;
    if (x > 0 && x < 9 && inside > 0.15F && inside < 0.6F && y > 0 && y < bar) c = {0.2F, 0.5F, 0.75F};
    if (x > 0 && x < 9 && inside > 0.6F && inside < 0.9F && y > 0 && y < bar * 0.7F) c = {0.93F, 0.58F, 0.2F};
    if (std::abs(u - 0.095F) < 0.003F || std::abs(v - 0.852F) < 0.004F) c = ink;
  }
  return {c, 1};
}

/// Returns the colour of a picture of hills, paler with distance.
glm::vec4 hills_colour(float u, float v) {
  glm::vec3 c = glm::mix(glm::vec3(0.95F, 0.75F, 0.5F), glm::vec3(0.35F, 0.55F, 0.8F), std::max(0.0F, 1 - 1.6F * v));
  for (std::uint32_t k = 0; k < 5; ++k) {
    const float near = static_cast<float>(k) / 4;
    const float ridge =
        0.38F + 0.13F * static_cast<float>(k) - 0.22F * fractal_noise(u * 0.99F, 0.37F, 3 + k, 5, 20 + k);
    if (v > ridge) c = glm::mix(glm::vec3(0.62F, 0.68F, 0.75F), glm::vec3(0.12F, 0.24F, 0.12F), near);
  }
  return {c * (0.9F + 0.2F * fractal_noise(u, v, 32, 3, 9)), 1};
}

glm::vec4 sea_colour(float u, float v) {
  const float sun = glm::length(glm::vec2(u - 0.68F, (v - 0.34F) * 0.7F));
  glm::vec3 c = glm::mix(glm::vec3(0.25F, 0.45F, 0.75F), glm::vec3(0.95F, 0.72F, 0.55F), std::min(1.0F, 1.9F * v));
  if (sun < 0.07F) c = {1, 0.95F, 0.8F};
  if (v > 0.52F) {
    const float wave = fractal_noise(u, v * v, 12, 4, 33);
    c = glm::mix(glm::vec3(0.08F, 0.28F, 0.42F), glm::vec3(0.45F, 0.62F, 0.68F), wave * wave);
    if (std::abs(u - 0.68F) < 0.05F + 0.08F * wave) c += glm::vec3(0.3F, 0.24F, 0.15F) * wave;
  }
  return {c, 1};
}

/// Returns the colour of an abstract picture: blocks of colour between black lines.
glm::vec4 shapes_colour(float u, float v) {
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
  return {inks[static_cast<std::uint64_t>(random_unit(3, i, j) * 7)] * (0.95F + 0.05F * fractal_noise(u, v, 64, 2, 4)),
          1};
}

/// Returns the colour of a laptop's screen with a window of text.
glm::vec4 page_colour(float u, float v) {
  glm::vec3 c(0.93F, 0.95F, 0.97F);
  if (v < 0.08F) c = {0.2F, 0.32F, 0.5F};
  if (u < 0.18F && v >= 0.08F) c = {0.78F, 0.83F, 0.88F};
  const float line = v * 24 - std::floor(v * 24);
  const auto row = static_cast<std::uint64_t>(v * 24);
  if (v > 0.12F && v < 0.95F && u > 0.23F && u < 0.6F + 0.33F * random_unit(8, row) && line < 0.45F &&
      random_unit(9, row, static_cast<std::uint64_t>(u * 110)) > 0.22F) {
    c = {0.25F, 0.27F, 0.32F};
  }
  return {c, 1};
}

}  // namespace

void add_room_textures(Scene& scene) {
  scene.textures = {
      paint_texture("carpet", 512, 512, carpet_colour),
      wood_texture("panelling wood", {0.66F, 0.44F, 0.25F}, {0.42F, 0.24F, 0.12F}, 3),
      wood_texture("table wood", {0.50F, 0.28F, 0.15F}, {0.26F, 0.12F, 0.06F}, 5),
      cloth_texture("upholstery", {0.20F, 0.30F, 0.42F}, {0.13F, 0.20F, 0.30F}, 48, 6, 256),
      paint_texture("chart", 512, 512, chart_colour),
      paint_texture("hills", 512, 256, hills_colour),
      paint_texture("sea", 512, 256, sea_colour),
      paint_texture("shapes", 256, 256, shapes_colour),
      paint_texture("page", 256, 256, page_colour),
  };
}

Materials add_materials(Scene& scene) {
  const auto with_picture = [&scene](const char* name, Picture picture, float mirror = 0) {
    return add_material(scene, make_textured(name, picture, glm::vec3(1), mirror));
  };
  const auto with_paint = [&scene](const char* name, const glm::vec3& colour, float mirror = 0) {
    return add_material(scene, make_paint(name, colour, mirror));
  };
  Material ceiling = make_paint("ceiling board", {0.86F, 0.85F, 0.82F});
  ceiling.emission = {0.33F, 0.32F, 0.30F};  // replaces light that the room reflects to the ceiling
  Material panel = make_lamp("lamp panel", glm::vec3(0.98F, 0.96F, 0.9F));
  Material screen = make_textured("projection", kChart, glm::vec3(0.25F));
  screen.emission = glm::vec3(0.42F);
  screen.emission_texture.texture = kChart;
  Material glow = make_textured("laptop screen", kKeys, glm::vec3(0.3F));
  glow.emission = glm::vec3(0.5F);
  glow.emission_texture.texture = kKeys;
  panel.casts_light = screen.casts_light = glow.casts_light = ceiling.casts_light = false;
  Materials materials{};
  materials.carpet = with_picture("carpet", kCarpet);
  materials.wall = with_paint("wall paint", {0.83F, 0.79F, 0.70F});
  materials.ceiling = add_material(scene, ceiling);
  materials.ceiling_grid = with_paint("ceiling grid", {0.75F, 0.75F, 0.74F});
  materials.lamp = add_material(scene, panel);
  materials.wood = with_picture("panelling", kWood);
  materials.table_wood = with_picture("table top", kTableWood, 0.08F);
  materials.white = with_paint("white lacquer", {0.85F, 0.85F, 0.83F});
  materials.dark = with_paint("black plastic", {0.045F, 0.045F, 0.05F});
  materials.steel = add_material(scene, make_metal("brushed steel", {0.72F, 0.73F, 0.75F}, 0.45F));
  materials.fabric = with_picture("upholstery", kFabric);
  materials.chart = with_paint("whiteboard", {0.9F, 0.91F, 0.92F}, 0.04F);
  materials.screen = add_material(scene, screen);
  materials.hills = with_picture("picture of hills", kHills);
  materials.sea = with_picture("picture of the sea", kSea);
  materials.shapes = with_picture("picture of shapes", kShapes);
  materials.slats = with_paint("window slats", {0.80F, 0.79F, 0.75F});
  materials.leaf = with_paint("leaves", {0.13F, 0.36F, 0.10F});
  materials.terracotta = with_paint("terracotta", {0.66F, 0.33F, 0.20F});
  materials.soil = with_paint("soil", {0.12F, 0.08F, 0.05F});
  materials.paper = with_paint("paper", {0.9F, 0.89F, 0.85F});
  materials.red = with_paint("red", {0.66F, 0.12F, 0.09F});
  materials.blue = with_paint("blue", {0.12F, 0.22F, 0.5F});
  materials.china = with_paint("china", {0.88F, 0.87F, 0.84F}, 0.05F);
  materials.keys = with_paint("laptop case", {0.42F, 0.43F, 0.45F});
  materials.glow = add_material(scene, glow);
  materials.brass = add_material(scene, make_metal("brass", {0.80F, 0.60F, 0.30F}, 0.4F));
  return materials;
}

namespace {

constexpr float kPanelling = 1.02F;  // height of the wall panelling
constexpr glm::vec2 kField[] = {{0, 0},         {0, 0.022F},      {0.085F, 0.022F},
                                {0.1F, 0.008F}, {0.115F, 0.008F}, {0.16F, 0.02F}};

/// Makes the panelling of a wall, `width` wide, in the wall's coordinates: raised fields, base board, rail on top.
Mesh make_panelling(float width, const Detail& detail) {
  Mesh mesh;
  mesh.name = "panelling";
  const auto count = static_cast<std::uint32_t>(width / 0.66F + 0.5F);
  const float step = width / static_cast<float>(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Mesh field = make_panel("", step, kPanelling - 0.17F, detail.coarser_profile(kField), detail.cell_count(3));
    append_mesh(mesh, transform_mesh(field, placement_at({static_cast<float>(k) * step, 0.12F, 0})));
  }
  const glm::vec2 base[] = {{0, 0}, {0.03F, 0}, {0.03F, 0.1F}, {0.024F, 0.12F}, {0, 0.12F}};
  const glm::vec2 rail[] = {{0, 0}, {0.025F, 0}, {0.03F, 0.01F}, {0.045F, 0.035F}, {0.045F, 0.05F}, {0, 0.05F}};
  // x of the outlines becomes the direction out of the wall, z the direction along it.
  const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {width, 0, 0, 1}};
  append_mesh(mesh, transform_mesh(make_extrusion("", base, width), along));
  append_mesh(mesh, transform_mesh(transform_mesh(make_extrusion("", rail, width), along),
                                   placement_at({0, kPanelling - 0.05F, 0})));
  return mesh;
}

void add_panelling(Scene& scene, const Materials& materials, const Detail& detail, const glm::vec3& origin,
                   const glm::vec3& outward, float width) {
  Mesh mesh = transform_mesh(make_panelling(width, detail), wall_axes(origin, outward));
  project_uvs(mesh, 0.9F, true);
  add_object(scene, std::move(mesh), materials.wood);
}

void add_door(Scene& scene, const Materials& materials, const Detail& detail) {
  const glm::mat4 wall = wall_axes({-kHalfLength, 0, 2.55F}, {1, 0, 0});
  constexpr float kWidth = 0.95F, kTall = 2.1F;
  Mesh frame;
  frame.name = "door frame";
  append_mesh(frame, make_box("", {-0.1F, 0, 0}, {0, kTall + 0.1F, 0.06F}));
  append_mesh(frame, make_box("", {kWidth, 0, 0}, {kWidth + 0.1F, kTall + 0.1F, 0.06F}));
  append_mesh(frame, make_box("", {0, kTall, 0}, {kWidth, kTall + 0.1F, 0.06F}));
  Mesh leaf = make_panel("door", kWidth, kTall, std::array<glm::vec2, 2>{{{0, 0}, {0, 0.025F}}});
  for (const auto& [low, high] : {std::pair{0.12F, 0.95F}, std::pair{1.05F, 1.98F}}) {
    for (const float x : {0.1F, 0.51F}) {
      const Mesh field = make_panel("", 0.34F, high - low, detail.coarser_profile(kField), detail.cell_count(3));
      append_mesh(leaf, transform_mesh(field, placement_at({x, low, 0.02F})));
    }
  }
  for (Mesh* part : {&frame, &leaf}) {
    *part = transform_mesh(std::move(*part), wall);
    project_uvs(*part, 0.9F, true);
    add_object(scene, std::move(*part), materials.wood);
  }
  const std::uint32_t round = detail.cell_count(12, 5);
  Mesh handle = transform_mesh(make_cylinder("door handle", 0.028F, 0.012F, round),
                               rotation_about({0.88F, 1.02F, 0.025F}, {1, 0, 0}, 0.25));
  const glm::vec3 grip[] = {
      {0.88F, 1.02F, 0.03F}, {0.88F, 1.02F, 0.075F}, {0.85F, 1.02F, 0.085F}, {0.75F, 1.02F, 0.08F}};
  append_mesh(handle, make_tube("", catmull_rom(grip, detail.cell_count(6, 2)), std::array{0.01F}, round));
  add_object(scene, transform_mesh(std::move(handle), wall), materials.brass);
}

/// Adds one wall of the room, without its panelling.
void add_wall(Scene& scene, const Materials& materials, const Detail& detail, const glm::vec3& origin,
              const glm::vec3& outward, float width, float height) {
  const Mesh wall = make_quad("wall", glm::vec3(0), {width, 0, 0}, {0, height, 0}, detail.cell_count(12));
  add_object(scene, transform_mesh(wall, wall_axes(origin, outward)), materials.wall);
}

}  // namespace

void add_room(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float x = kHalfLength, z = kHalfWidth;
  Mesh floor = make_quad("carpet", {-x, 0, -z}, {0, 0, 2 * z}, {2 * x, 0, 0}, detail.cell_count(24));
  project_uvs(floor, 0.8F);
  add_object(scene, std::move(floor), materials.carpet);
  add_wall(scene, materials, detail, {-x, 0, -z}, {0, 0, 1}, 2 * x, kHeight);
  add_wall(scene, materials, detail, {x, 0, -z}, {-1, 0, 0}, 2 * z, kHeight);
  add_wall(scene, materials, detail, {-x, 0, z}, {1, 0, 0}, 2 * z, kHeight);
  add_panelling(scene, materials, detail, {-x, 0, -z}, {0, 0, 1}, 2 * x);
  add_panelling(scene, materials, detail, {x, 0, -z}, {-1, 0, 0}, 2 * z);
  add_panelling(scene, materials, detail, {x, 0, z}, {0, 0, -1}, 2 * x);
  add_panelling(scene, materials, detail, {-x, 0, z}, {1, 0, 0}, 0.55F);
  add_panelling(scene, materials, detail, {-x, 0, 1.5F}, {1, 0, 0}, z + 1.5F);
  add_door(scene, materials, detail);
}

/// Adds a cornice along all walls of the room.
void add_cornice(Scene& scene, const Materials& materials) {
  const glm::vec2 outline[] = {{0, 0}, {0.02F, 0}, {0.03F, 0.03F}, {0.06F, 0.045F}, {0.09F, 0.09F}, {0, 0.09F}};
  Mesh cornice;
  cornice.name = "cornice";
  const auto add_side = [&](const glm::vec3& origin, const glm::vec3& outward, float width) {
    const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {width, 0, 0, 1}};
    append_mesh(cornice,
                transform_mesh(transform_mesh(make_extrusion("", outline, width), along), wall_axes(origin, outward)));
  };
  constexpr float y = kHeight - 0.12F;
  add_side({-kHalfLength, y, -kHalfWidth}, {0, 0, 1}, 2 * kHalfLength);
  add_side({kHalfLength, y, kHalfWidth}, {0, 0, -1}, 2 * kHalfLength);
  add_side({kHalfLength, y, -kHalfWidth}, {-1, 0, 0}, 2 * kHalfWidth);
  add_side({-kHalfLength, y, kHalfWidth}, {1, 0, 0}, 2 * kHalfWidth);
  add_object(scene, std::move(cornice), materials.white);
}

void add_ceiling(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr int kColumns = 14, kRows = 10;
  constexpr float kStepX = 2 * kHalfLength / kColumns, kStepZ = 2 * kHalfWidth / kRows;
  const glm::vec2 board_rings[] = {{0.012F, -0.02F}, {0.012F, -0.008F}, {0.03F, 0}};
  Mesh boards, panels, grid;
  boards.name = "ceiling boards";
  panels.name = "lamp panels";
  grid.name = "ceiling grid";
  const Mesh board = make_panel("", kStepX, kStepZ, detail.coarser_profile(board_rings), detail.cell_count(2));
  const auto is_lamp = [](int i, int j) { return i % 4 != 0 && i % 4 != 3 && (j == 2 || j == 7 || j == 4 || j == 5); };
  const std::uint32_t cells = std::min(detail.cell_count(6, 3), 12U);
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const glm::vec3 corner(-kHalfLength + kStepX * static_cast<float>(i), kHeight,
                             -kHalfWidth + kStepZ * static_cast<float>(j));
      if (!is_lamp(i, j)) {
        append_mesh(boards, transform_mesh(board, ceiling_axes(corner)));
        continue;
      }
      append_mesh(panels, make_quad("", corner + glm::vec3(0, 0.03F, 0), {kStepX, 0, 0}, {0, 0, kStepZ}, 1));
      for (std::uint32_t k = 1; k < cells; ++k) {  // louvres
        const float share = static_cast<float>(k) / static_cast<float>(cells);
        append_mesh(grid, make_box("", corner + glm::vec3(share * kStepX - 0.004F, 0.002F, 0),
                                   corner + glm::vec3(share * kStepX + 0.004F, 0.028F, kStepZ)));
        append_mesh(grid, make_box("", corner + glm::vec3(0, 0.003F, share * kStepZ - 0.004F),
                                   corner + glm::vec3(kStepX, 0.027F, share * kStepZ + 0.004F)));
      }
    }
  }
  for (int i = 0; i <= kColumns; ++i) {
    const float at = -kHalfLength + kStepX * static_cast<float>(i);
    append_mesh(grid,
                make_box("", {at - 0.013F, kHeight - 0.004F, -kHalfWidth}, {at + 0.013F, kHeight + 0.02F, kHalfWidth}));
  }
  for (int j = 0; j <= kRows; ++j) {
    const float at = -kHalfWidth + kStepZ * static_cast<float>(j);
    append_mesh(
        grid, make_box("", {-kHalfLength, kHeight - 0.003F, at - 0.013F}, {kHalfLength, kHeight + 0.02F, at + 0.013F}));
  }
  add_object(scene, std::move(boards), materials.ceiling);
  add_object(scene, std::move(panels), materials.lamp);
  add_object(scene, std::move(grid), materials.ceiling_grid);
  add_object(scene,
             make_quad("ceiling back", {-kHalfLength, kHeight + 0.04F, -kHalfWidth}, {2 * kHalfLength, 0, 0},
                       {0, 0, 2 * kHalfWidth}, 1),
             materials.dark);
  add_cornice(scene, materials);
}

/// Adds three windows in the wall at +z, with curved slats in front of them.
void add_windows(Scene& scene, const Materials& materials, const Detail& detail) {
  constexpr float kLow = 1.05F, kHigh = 2.5F, kWide = 2.3F, kLeft[] = {0.6F, 3.45F, 6.3F};
  const glm::mat4 wall = wall_axes({kHalfLength, 0, kHalfWidth}, {0, 0, -1});
  Mesh plaster, frame;
  plaster.name = "window wall";
  frame.name = "window frames";
  const auto add_piece = [&](float x0, float x1, float y0, float y1) {
    append_mesh(plaster, make_quad("", {x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, detail.cell_count(6)));
  };
  add_piece(0, 2 * kHalfLength, 0, kLow);
  add_piece(0, 2 * kHalfLength, kHigh, kHeight);
  float from = 0;
  for (const float left : kLeft) {
    add_piece(from, left, kLow, kHigh);
    from = left + kWide;
    for (int k = 0; k <= 2; ++k) {
      const float x = left + (kWide - 0.05F) * static_cast<float>(k) / 2;
      append_mesh(frame, make_box("", {x, kLow, -0.12F}, {x + 0.05F, kHigh, -0.06F}));
    }
    append_mesh(frame, make_box("", {left, kLow, -0.12F}, {left + kWide, kLow + 0.05F, -0.06F}));
    append_mesh(frame, make_box("", {left, kHigh - 0.05F, -0.12F}, {left + kWide, kHigh, -0.06F}));
    append_mesh(frame,
                make_box("", {left - 0.05F, kLow - 0.03F, -0.15F}, {left + kWide + 0.05F, kLow, 0.07F}));  // sill
    append_mesh(frame, make_box("", {left, kHigh - 0.005F, -0.15F}, {left + kWide, kHigh, 0}));            // reveals
    append_mesh(frame, make_box("", {left, kLow, -0.15F}, {left + 0.004F, kHigh, 0}));
    append_mesh(frame, make_box("", {left + kWide - 0.004F, kLow, -0.15F}, {left + kWide, kHigh, 0}));
  }
  add_piece(from, 2 * kHalfLength, kLow, kHigh);
  add_object(scene, transform_mesh(std::move(plaster), wall), materials.wall);
  add_object(scene, transform_mesh(std::move(frame), wall), materials.white);

  constexpr int kSlats = 28;
  const std::uint32_t blind = [&] {
    Mesh mesh;
    mesh.name = "blind";
    for (int k = 0; k < kSlats; ++k) {
      const float y = kLow + 0.1F + (kHigh - kLow - 0.12F) * static_cast<float>(k) / kSlats;
      append_mesh(mesh, make_surface("", detail.cell_count(4), detail.cell_count(4, 2), [y](float s, float t) {
                    const float across = 2 * t - 1;
                    return glm::vec3(0.02F + s * (kWide - 0.04F), y + 0.011F * across + 0.004F * (1 - across * across),
                                     -0.03F + 0.02F * across);
                  }));
    }
    append_mesh(mesh, make_box("", {0.01F, kHigh - 0.05F, -0.055F}, {kWide - 0.01F, kHigh - 0.01F, -0.005F}));
    append_mesh(mesh, make_box("", {0.02F, kLow + 0.05F, -0.045F}, {kWide - 0.02F, kLow + 0.07F, -0.015F}));
    for (const float x : {0.35F, kWide - 0.35F}) {
      for (const float z : {-0.052F, -0.008F}) {
        append_mesh(mesh, make_box("", {x, kLow + 0.06F, z - 0.001F}, {x + 0.003F, kHigh - 0.03F, z + 0.001F}));
      }
    }
    return add_mesh(scene, std::move(mesh), materials.slats);
  }();
  for (const float left : kLeft) add_instance(scene, blind, wall * placement_at({left, 0, 0}));
}

}  // namespace traces::conference

namespace traces {
namespace {

using namespace conference;

Scene furnish_room(const Detail& detail) {
  Scene scene;
  scene.name = "conference";
  scene.background = {0.72F, 0.82F, 0.95F};
  const Materials materials = add_materials(scene);
  add_room(scene, materials, detail);
  add_ceiling(scene, materials, detail);
  add_windows(scene, materials, detail);
  add_table(scene, materials, detail);
  add_chairs(scene, materials, detail);
  add_wall_things(scene, materials, detail);
  add_table_things(scene, materials, detail);
  add_plant(scene, materials, detail);
  return scene;
}

void add_cameras(Scene& scene) {
  scene.cameras.push_back(look_at("corner", {-4.2F, 1.78F, 2.75F}, {0.75F, 0.72F, -0.45F}, 0.72F));
  scene.cameras.push_back(look_at("along", {-3.95F, 1.5F, -0.35F}, {2.5F, 0.8F, 0.15F}, 0.75F));
  scene.cameras.push_back(look_at("windows", {2.9F, 1.6F, -2.85F}, {-0.9F, 0.75F, 1.2F}, 0.78F));
  scene.cameras.push_back(look_at("seated", {-1.75F, 1.22F, -1.0F}, {1.6F, 0.72F, 0.75F}, 0.7F));
  scene.cameras.push_back(look_at("door", {4.15F, 2.35F, 2.3F}, {-1.6F, 0.7F, -0.9F}, 0.75F));
  const ViewKey keys[] = {
      {0, {-4.2F, 1.78F, 2.75F}, {0.75F, 0.72F, -0.45F}}, {4, {-2.0F, 1.7F, 2.6F}, {0.6F, 0.75F, 0}},
      {8, {1.2F, 1.6F, 2.5F}, {0.2F, 0.8F, -0.6F}},       {12, {3.6F, 1.6F, 1.6F}, {-0.4F, 0.8F, -0.5F}},
      {16, {4.0F, 1.7F, -0.6F}, {-1.2F, 0.8F, -0.2F}},    {20, {3.0F, 1.8F, -2.6F}, {-1.0F, 0.8F, 0.8F}}};
  add_camera_path(scene, "path", keys, 0.72F);
}

}  // namespace

/// Builds a room like Anat Grynberg's and Greg Ward's conference room: much diffuse furniture under a lit ceiling.
Scene build_conference(const BuiltinOptions& options) {
  constexpr std::uint32_t kClass = 190'000;
  Scene scene = build_to_size(options.triangles_or_default(kClass), furnish_room);
  add_room_textures(scene);
  add_cameras(scene);
  for (const float x : {-2.4F, 0.0F, 2.4F}) {
    Light light;
    light.position = {x, kHeight - 0.35F, 0};
    light.intensity = glm::vec3(1, 0.95F, 0.87F);
    scene.lights.push_back(light);
  }
  finish_scene(scene, {0.27F, 0.265F, 0.26F});
  return scene;
}

}  // namespace traces
