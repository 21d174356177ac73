#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::conference {

// Dimensions of the room in metres: 9.2 x 6.4 x 2.9, with the origin in the middle of its floor. The windows are at +z,
// the screen at +x, the door at -x.
inline constexpr float kHalfLength = 4.6F, kHalfWidth = 3.2F, kHeight = 2.9F;
inline constexpr float kTableHeight = 0.74F;

/// Indices of the conference room's textures in Scene::textures.
enum Picture : std::uint32_t { kCarpet, kWood, kTableWood, kFabric, kChart, kHills, kSea, kShapes, kKeys, kPictures };
void add_room_textures(Scene& scene);

/// Indices of the conference room's materials in Scene::materials.
struct Materials {
  std::uint32_t carpet, wall, ceiling, ceiling_grid, lamp, wood, table_wood, white, dark, steel, fabric, chart, screen,
      hills, sea, shapes, slats, leaf, terracotta, soil, paper, red, blue, china, keys, glow, brass;
};
Materials add_materials(Scene& scene);

void add_room(Scene& scene, const Materials& materials, const Detail& detail);
void add_ceiling(Scene& scene, const Materials& materials, const Detail& detail);
void add_windows(Scene& scene, const Materials& materials, const Detail& detail);
void add_table(Scene& scene, const Materials& materials, const Detail& detail);
void add_chairs(Scene& scene, const Materials& materials, const Detail& detail);
void add_wall_things(Scene& scene, const Materials& materials, const Detail& detail);
void add_table_things(Scene& scene, const Materials& materials, const Detail& detail);
void add_plant(Scene& scene, const Materials& materials, const Detail& detail);

}  // namespace traces::conference
