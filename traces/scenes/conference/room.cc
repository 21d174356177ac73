#include <algorithm>
#include <array>
#include <vector>

#include "traces/scenes/conference/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"
#include "traces/scenes/modelling/trigonometry.h"

namespace traces::conference {
namespace {

constexpr float kPanelling = 1.02F;  // height
constexpr glm::vec2 kField[] = {{0, 0},         {0, 0.022F},      {0.085F, 0.022F},
                                {0.1F, 0.008F}, {0.115F, 0.008F}, {0.16F, 0.02F}};

/// Makes a wainscot of that width in a wall's coordinates: raised fields, a base board and a rail on top.
Mesh make_panelling(float width, const Detail& detail) {
  Mesh mesh;
  mesh.name = "panelling";
  const auto count = static_cast<std::uint32_t>(width / 0.66F + 0.5F);
  const float step = width / static_cast<float>(count);
  for (std::uint32_t k = 0; k < count; ++k) {
    const Mesh field = make_panel("", step, kPanelling - 0.17F, detail.profile(kField), detail.cells(3));
    append(mesh, transformed(field, placed({static_cast<float>(k) * step, 0.12F, 0})));
  }
  const glm::vec2 base[] = {{0, 0}, {0.03F, 0}, {0.03F, 0.1F}, {0.024F, 0.12F}, {0, 0.12F}};
  const glm::vec2 rail[] = {{0, 0}, {0.025F, 0}, {0.03F, 0.01F}, {0.045F, 0.035F}, {0.045F, 0.05F}, {0, 0.05F}};
  // The outlines' x becomes the direction out of the wall, their z the direction along it.
  const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {width, 0, 0, 1}};
  append(mesh, transformed(make_extrusion("", base, width), along));
  append(mesh, transformed(transformed(make_extrusion("", rail, width), along), placed({0, kPanelling - 0.05F, 0})));
  return mesh;
}

void add_panelling(Scene& scene, const Materials& is, const Detail& detail, const glm::vec3& origin,
                   const glm::vec3& outward, float width) {
  Mesh mesh = transformed(make_panelling(width, detail), standing(origin, outward));
  project_uvs(mesh, 0.9F, true);
  add_object(scene, std::move(mesh), is.wood);
}

void add_door(Scene& scene, const Materials& is, const Detail& detail) {
  const glm::mat4 wall = standing({-kHalfLength, 0, 2.55F}, {1, 0, 0});
  constexpr float kWidth = 0.95F, kTall = 2.1F;
  Mesh frame;
  frame.name = "door frame";
  append(frame, make_box("", {-0.1F, 0, 0}, {0, kTall + 0.1F, 0.06F}));
  append(frame, make_box("", {kWidth, 0, 0}, {kWidth + 0.1F, kTall + 0.1F, 0.06F}));
  append(frame, make_box("", {0, kTall, 0}, {kWidth, kTall + 0.1F, 0.06F}));
  Mesh leaf = make_panel("door", kWidth, kTall, std::array<glm::vec2, 2>{{{0, 0}, {0, 0.025F}}});
  for (const auto& [low, high] : {std::pair{0.12F, 0.95F}, std::pair{1.05F, 1.98F}}) {
    for (const float x : {0.1F, 0.51F}) {
      const Mesh field = make_panel("", 0.34F, high - low, detail.profile(kField), detail.cells(3));
      append(leaf, transformed(field, placed({x, low, 0.02F})));
    }
  }
  for (Mesh* part : {&frame, &leaf}) {
    *part = transformed(std::move(*part), wall);
    project_uvs(*part, 0.9F, true);
    add_object(scene, std::move(*part), is.wood);
  }
  const std::uint32_t round = detail.cells(12, 5);
  Mesh handle =
      transformed(make_cylinder("door handle", 0.028F, 0.012F, round), turned({0.88F, 1.02F, 0.025F}, {1, 0, 0}, 0.25));
  const glm::vec3 grip[] = {
      {0.88F, 1.02F, 0.03F}, {0.88F, 1.02F, 0.075F}, {0.85F, 1.02F, 0.085F}, {0.75F, 1.02F, 0.08F}};
  append(handle, make_tube("", smoothed(grip, detail.cells(6, 2)), std::array{0.01F}, round));
  add_object(scene, transformed(std::move(handle), wall), is.brass);
}

/// Adds one wall above the panelling.
void add_wall(Scene& scene, const Materials& is, const Detail& detail, const glm::vec3& origin,
              const glm::vec3& outward, float width, float height) {
  const Mesh wall = make_quad("wall", glm::vec3(0), {width, 0, 0}, {0, height, 0}, detail.cells(12));
  add_object(scene, transformed(wall, standing(origin, outward)), is.wall);
}

}  // namespace

void add_room(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float x = kHalfLength, z = kHalfWidth;
  Mesh floor = make_quad("carpet", {-x, 0, -z}, {0, 0, 2 * z}, {2 * x, 0, 0}, detail.cells(24));
  project_uvs(floor, 0.8F);
  add_object(scene, std::move(floor), is.carpet);
  add_wall(scene, is, detail, {-x, 0, -z}, {0, 0, 1}, 2 * x, kHeight);
  add_wall(scene, is, detail, {x, 0, -z}, {-1, 0, 0}, 2 * z, kHeight);
  add_wall(scene, is, detail, {-x, 0, z}, {1, 0, 0}, 2 * z, kHeight);
  add_panelling(scene, is, detail, {-x, 0, -z}, {0, 0, 1}, 2 * x);
  add_panelling(scene, is, detail, {x, 0, -z}, {-1, 0, 0}, 2 * z);
  add_panelling(scene, is, detail, {x, 0, z}, {0, 0, -1}, 2 * x);
  add_panelling(scene, is, detail, {-x, 0, z}, {1, 0, 0}, 0.55F);
  add_panelling(scene, is, detail, {-x, 0, 1.5F}, {1, 0, 0}, z + 1.5F);
  add_door(scene, is, detail);
}

/// Adds a cornice along all walls.
void add_cornice(Scene& scene, const Materials& is) {
  const glm::vec2 outline[] = {{0, 0}, {0.02F, 0}, {0.03F, 0.03F}, {0.06F, 0.045F}, {0.09F, 0.09F}, {0, 0.09F}};
  Mesh cornice;
  cornice.name = "cornice";
  const auto add_side = [&](const glm::vec3& origin, const glm::vec3& outward, float width) {
    const glm::mat4 along{{0, 0, 1, 0}, {0, 1, 0, 0}, {-1, 0, 0, 0}, {width, 0, 0, 1}};
    append(cornice, transformed(transformed(make_extrusion("", outline, width), along), standing(origin, outward)));
  };
  constexpr float y = kHeight - 0.12F;
  add_side({-kHalfLength, y, -kHalfWidth}, {0, 0, 1}, 2 * kHalfLength);
  add_side({kHalfLength, y, kHalfWidth}, {0, 0, -1}, 2 * kHalfLength);
  add_side({kHalfLength, y, -kHalfWidth}, {-1, 0, 0}, 2 * kHalfWidth);
  add_side({-kHalfLength, y, kHalfWidth}, {1, 0, 0}, 2 * kHalfWidth);
  add_object(scene, std::move(cornice), is.white);
}

void add_ceiling(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr int kColumns = 14, kRows = 10;
  constexpr float kStepX = 2 * kHalfLength / kColumns, kStepZ = 2 * kHalfWidth / kRows;
  const glm::vec2 board_rings[] = {{0.012F, -0.02F}, {0.012F, -0.008F}, {0.03F, 0}};
  Mesh boards, panels, grid;
  boards.name = "ceiling boards";
  panels.name = "lamp panels";
  grid.name = "ceiling grid";
  const Mesh board = make_panel("", kStepX, kStepZ, detail.profile(board_rings), detail.cells(2));
  const auto is_lamp = [](int i, int j) { return i % 4 != 0 && i % 4 != 3 && (j == 2 || j == 7 || j == 4 || j == 5); };
  const std::uint32_t cells = std::min(detail.cells(6, 3), 12U);
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const glm::vec3 corner(-kHalfLength + kStepX * static_cast<float>(i), kHeight,
                             -kHalfWidth + kStepZ * static_cast<float>(j));
      if (!is_lamp(i, j)) {
        append(boards, transformed(board, hanging(corner)));
        continue;
      }
      append(panels, make_quad("", corner + glm::vec3(0, 0.03F, 0), {kStepX, 0, 0}, {0, 0, kStepZ}, 1));
      for (std::uint32_t k = 1; k < cells; ++k) {  // louvres
        const float share = static_cast<float>(k) / static_cast<float>(cells);
        append(grid, make_box("", corner + glm::vec3(share * kStepX - 0.004F, 0.002F, 0),
                              corner + glm::vec3(share * kStepX + 0.004F, 0.028F, kStepZ)));
        append(grid, make_box("", corner + glm::vec3(0, 0.003F, share * kStepZ - 0.004F),
                              corner + glm::vec3(kStepX, 0.027F, share * kStepZ + 0.004F)));
      }
    }
  }
  for (int i = 0; i <= kColumns; ++i) {
    const float at = -kHalfLength + kStepX * static_cast<float>(i);
    append(grid,
           make_box("", {at - 0.013F, kHeight - 0.004F, -kHalfWidth}, {at + 0.013F, kHeight + 0.02F, kHalfWidth}));
  }
  for (int j = 0; j <= kRows; ++j) {
    const float at = -kHalfWidth + kStepZ * static_cast<float>(j);
    append(grid,
           make_box("", {-kHalfLength, kHeight - 0.003F, at - 0.013F}, {kHalfLength, kHeight + 0.02F, at + 0.013F}));
  }
  add_object(scene, std::move(boards), is.ceiling);
  add_object(scene, std::move(panels), is.lamp);
  add_object(scene, std::move(grid), is.ceiling_grid);
  add_object(scene,
             make_quad("ceiling back", {-kHalfLength, kHeight + 0.04F, -kHalfWidth}, {2 * kHalfLength, 0, 0},
                       {0, 0, 2 * kHalfWidth}, 1),
             is.dark);
  add_cornice(scene, is);
}

/// Adds three windows in the wall at +z, with curved slats before them.
void add_windows(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float kLow = 1.05F, kHigh = 2.5F, kWide = 2.3F, kLeft[] = {0.6F, 3.45F, 6.3F};
  const glm::mat4 wall = standing({kHalfLength, 0, kHalfWidth}, {0, 0, -1});
  Mesh plaster, frame;
  plaster.name = "window wall";
  frame.name = "window frames";
  const auto add_piece = [&](float x0, float x1, float y0, float y1) {
    append(plaster, make_quad("", {x0, y0, 0}, {x1 - x0, 0, 0}, {0, y1 - y0, 0}, detail.cells(6)));
  };
  add_piece(0, 2 * kHalfLength, 0, kLow);
  add_piece(0, 2 * kHalfLength, kHigh, kHeight);
  float from = 0;
  for (const float left : kLeft) {
    add_piece(from, left, kLow, kHigh);
    from = left + kWide;
    for (int k = 0; k <= 2; ++k) {
      const float x = left + (kWide - 0.05F) * static_cast<float>(k) / 2;
      append(frame, make_box("", {x, kLow, -0.12F}, {x + 0.05F, kHigh, -0.06F}));
    }
    append(frame, make_box("", {left, kLow, -0.12F}, {left + kWide, kLow + 0.05F, -0.06F}));
    append(frame, make_box("", {left, kHigh - 0.05F, -0.12F}, {left + kWide, kHigh, -0.06F}));
    append(frame, make_box("", {left - 0.05F, kLow - 0.03F, -0.15F}, {left + kWide + 0.05F, kLow, 0.07F}));  // sill
    append(frame, make_box("", {left, kHigh - 0.005F, -0.15F}, {left + kWide, kHigh, 0}));                   // reveals
    append(frame, make_box("", {left, kLow, -0.15F}, {left + 0.004F, kHigh, 0}));
    append(frame, make_box("", {left + kWide - 0.004F, kLow, -0.15F}, {left + kWide, kHigh, 0}));
  }
  add_piece(from, 2 * kHalfLength, kLow, kHigh);
  add_object(scene, transformed(std::move(plaster), wall), is.wall);
  add_object(scene, transformed(std::move(frame), wall), is.white);

  constexpr int kSlats = 28;
  const std::uint32_t blind = [&] {
    Mesh mesh;
    mesh.name = "blind";
    for (int k = 0; k < kSlats; ++k) {
      const float y = kLow + 0.1F + (kHigh - kLow - 0.12F) * static_cast<float>(k) / kSlats;
      append(mesh, make_surface("", detail.cells(4), detail.cells(4, 2), [y](float s, float t) {
               const float across = 2 * t - 1;
               return glm::vec3(0.02F + s * (kWide - 0.04F), y + 0.011F * across + 0.004F * (1 - across * across),
                                -0.03F + 0.02F * across);
             }));
    }
    append(mesh, make_box("", {0.01F, kHigh - 0.05F, -0.055F}, {kWide - 0.01F, kHigh - 0.01F, -0.005F}));
    append(mesh, make_box("", {0.02F, kLow + 0.05F, -0.045F}, {kWide - 0.02F, kLow + 0.07F, -0.015F}));
    for (const float x : {0.35F, kWide - 0.35F}) {
      for (const float z : {-0.052F, -0.008F}) {
        append(mesh, make_box("", {x, kLow + 0.06F, z - 0.001F}, {x + 0.003F, kHigh - 0.03F, z + 0.001F}));
      }
    }
    return add_mesh(scene, std::move(mesh), is.slats);
  }();
  for (const float left : kLeft) add_instance(scene, blind, wall * placed({left, 0, 0}));
}

}  // namespace traces::conference
