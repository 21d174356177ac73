#include <array>

#include "traces/scenes/bathroom/parts.h"
#include "traces/scenes/modelling/forms.h"
#include "traces/scenes/modelling/shapes.h"
#include "traces/scenes/modelling/sweeps.h"

namespace traces::bathroom {
namespace {

constexpr float kTileWidth = 0.2F, kTileHeight = 0.1F, kJoint = 0.003F, kTiled = 2.1F;
constexpr int kAccentRow = 12;

/// Makes tiles in running bond over a wall's coordinates from `left` to `right`, cut at both ends. `accent`: only the
/// accent row.
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
      const Mesh tile = make_panel("", to - from, kTileHeight - kJoint, detail.profile(rings), detail.cells(1));
      append(mesh, transformed(tile, placed({from, kTileHeight * static_cast<float>(row) + 0.5F * kJoint, 0})));
    }
  }
  return mesh;
}

void add_tiled_wall(Scene& scene, const Materials& is, const Detail& detail, const glm::mat4& wall, float left,
                    float right) {
  add_object(scene, transformed(make_tiles(left, right, kTiled, false, detail), wall), is.tile);
  add_object(scene, transformed(make_tiles(left, right, kTiled, true, detail), wall), is.accent);
  const Mesh grout = make_quad("grout", {left, 0, 0.004F}, {right - left, 0, 0}, {0, kTiled, 0}, detail.cells(4));
  add_object(scene, transformed(grout, wall), is.grout);
  Mesh trim = make_rounded_box("trim", {left, kTiled, 0}, {right, kTiled + 0.035F, 0.022F}, 0.009F, detail.cells(3));
  add_object(scene, transformed(std::move(trim), wall), is.accent);
  const Mesh paint =
      make_quad("wall", {left, kTiled, 0}, {right - left, 0, 0}, {0, kHeight - kTiled, 0}, detail.cells(6));
  add_object(scene, transformed(paint, wall), is.wall);
}

void add_floor(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float kRadius = 0.058F, kAcross = 0.866025F * 2 * kRadius;
  const glm::vec2 profile[] = {
      {kRadius - 0.0015F, 0}, {kRadius - 0.0015F, 0.002F}, {kRadius - 0.004F, 0.004F}, {0, 0.004F}};
  const Mesh tile = make_lathe("", detail.profile(profile), 6);
  Mesh floor;
  floor.name = "floor tiles";
  for (int row = 0; row < 36; ++row) {
    for (int k = 0; k < 42; ++k) {
      const float z = -kHalfWidth + kAcross * (static_cast<float>(row) + (k % 2 == 0 ? 0.0F : 0.5F));
      const float x = -kHalfLength + 1.5F * kRadius * static_cast<float>(k);
      if (z > kHalfWidth + kRadius || x > kHalfLength + kRadius) continue;
      append(floor, transformed(tile, placed({x, 0, z})));
    }
  }
  project_uvs(floor, 0.7F);
  add_object(scene, std::move(floor), is.floor);
  add_object(scene,
             make_quad("floor grout", {-kHalfLength, 0.0022F, -kHalfWidth}, {0, 0, 2 * kHalfWidth},
                       {2 * kHalfLength, 0, 0}, detail.cells(4)),
             is.grout);
}

void add_door(Scene& scene, const Materials& is, const Detail& detail, const glm::mat4& wall, float left) {
  constexpr float kWidth = 0.84F, kTall = 2.06F;
  const glm::vec2 field[] = {{0, 0}, {0, 0.018F}, {0.1F, 0.018F}, {0.11F, 0.006F}};
  Mesh door;
  door.name = "door";
  for (const auto& [low, high] : {std::pair{0.01F, 0.98F}, std::pair{0.98F, kTall}}) {
    append(door, transformed(make_panel("", kWidth, high - low, detail.profile(field), detail.cells(3)),
                             placed({left, low, 0})));
  }
  for (const float x : {left - 0.09F, left + kWidth})
    append(door, make_box("", {x, 0, 0}, {x + 0.09F, kTall + 0.09F, 0.035F}));
  append(door, make_box("", {left, kTall, 0}, {left + kWidth, kTall + 0.09F, 0.035F}));
  door = transformed(std::move(door), wall);
  project_uvs(door, 0.9F, true);
  add_object(scene, std::move(door), is.oak);
  const glm::vec3 grip[] = {{left + 0.78F, 1.02F, 0.01F},
                            {left + 0.78F, 1.02F, 0.06F},
                            {left + 0.74F, 1.02F, 0.07F},
                            {left + 0.66F, 1.02F, 0.065F}};
  Mesh handle = make_tube("door handle", smoothed(grip, detail.cells(6, 2)), std::array{0.009F}, detail.cells(10, 5));
  add_object(scene, transformed(std::move(handle), wall), is.chrome);
}

}  // namespace

void add_walls(Scene& scene, const Materials& is, const Detail& detail) {
  constexpr float x = kHalfLength, z = kHalfWidth;
  add_tiled_wall(scene, is, detail, standing({-x, 0, -z}, {0, 0, 1}), 0, 2 * x);
  add_tiled_wall(scene, is, detail, standing({x, 0, -z}, {-1, 0, 0}), 0, 2 * z);
  add_tiled_wall(scene, is, detail, standing({-x, 0, z}, {1, 0, 0}), 0, 2 * z);
  const glm::mat4 front = standing({x, 0, z}, {0, 0, -1});
  constexpr float kDoorLeft = 0.7F, kDoorRight = kDoorLeft + 0.84F + 0.09F;
  add_tiled_wall(scene, is, detail, front, 0, kDoorLeft - 0.09F);
  add_tiled_wall(scene, is, detail, front, kDoorRight, 2 * x);
  add_door(scene, is, detail, front, kDoorLeft);
  add_object(scene,
             transformed(make_quad("wall above the door", {kDoorLeft - 0.09F, 2.1F, 0}, {1.02F, 0, 0},
                                   {0, kHeight - 2.1F, 0}, 2),
                         front),
             is.wall);
  add_floor(scene, is, detail);
  add_object(scene, make_quad("ceiling", {-x, kHeight, -z}, {2 * x, 0, 0}, {0, 0, 2 * z}, detail.cells(8)), is.ceiling);
  const glm::vec2 bowl[] = {{0, -0.12F}, {0.12F, -0.105F}, {0.18F, -0.07F}, {0.2F, -0.02F}};
  const glm::mat4 under_ceiling = placed({-0.3F, kHeight, 0.25F});
  add_object(
      scene,
      transformed(make_lathe("ceiling lamp", smoothed(detail.profile(bowl), detail.cells(4, 2)), detail.cells(36, 12)),
                  under_ceiling),
      is.lamp);
  const glm::vec2 ring[] = {{0.2F, -0.03F}, {0.215F, -0.03F}, {0.215F, 0}};
  add_object(scene, transformed(make_lathe("lamp ring", detail.profile(ring), detail.cells(36, 12)), under_ceiling),
             is.chrome);
}

}  // namespace traces::bathroom
