#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::atrium {

// The court in metres; the origin is the middle of its floor. Columns form a rectangle of 18 x 7.2, with arcades of two
// storeys on all sides, galleries 3 deep around them, and the sky above.
inline constexpr float kHalfLength = 9, kHalfWidth = 3.6F, kGallery = 3;
inline constexpr int kLongBays = 6, kShortBays = 3;
inline constexpr float kLongBay = 3.0F, kShortBay = 2.4F;
inline constexpr float kWall = 0.5F;  ///< thickness of an arcade
inline constexpr float kSpring = 3.0F, kUpper = 5.0F, kUpperSpring = 7.3F, kTop = 9.4F;

/// Indices in Scene::textures.
enum Picture : std::uint32_t { kAshlar, kBrick, kFloor, kStone, kWood, kRedBanner, kBlueBanner, kCurtain };
void paint_pictures(Scene& scene);

/// Indices in Scene::materials.
struct Materials {
  std::uint32_t ashlar, brick, floor, stone, light_stone, wood, plaster, red, blue, curtain, iron, leaf, clay, soil,
      water, glow;
};
Materials add_materials(Scene& scene);

void add_walls(Scene& scene, const Materials& is, const Detail& detail);
void add_arcades(Scene& scene, const Materials& is, const Detail& detail);
void add_columns(Scene& scene, const Materials& is, const Detail& detail);
void add_balustrades(Scene& scene, const Materials& is, const Detail& detail);
void add_cloth(Scene& scene, const Materials& is, const Detail& detail);
void add_fountain(Scene& scene, const Materials& is, const Detail& detail);
void add_plants(Scene& scene, const Materials& is, const Detail& detail);
void add_lanterns(Scene& scene, const Materials& is, const Detail& detail);

/// Calls visit(middle of the bay, direction into the court, width) for all bays of the rectangle.
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

}  // namespace traces::atrium
