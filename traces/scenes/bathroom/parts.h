#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "traces/scene/scene.h"
#include "traces/scenes/modelling/detail.h"

namespace traces::bathroom {

// Dimensions of the room in metres; the origin is the middle of its floor. At -z are the bath tub (left) and the wash
// basin below the mirror (right); at +x toilet and towel radiator; at +z the door.
inline constexpr float kHalfLength = 1.8F, kHalfWidth = 1.45F, kHeight = 2.5F;
inline constexpr float kCounter = 0.84F;  ///< height of the counter with the wash basin
inline constexpr float kTubLeft = -1.74F, kTubHalf = 0.86F, kTubZ = -1.02F, kTubRim = 0.58F;

/// Indices of the bathroom's textures in Scene::textures.
enum Picture : std::uint32_t { kMarble, kOak, kTerry, kStripes, kLabel };
void add_room_textures(Scene& scene);

/// Indices of the bathroom's materials in Scene::materials.
struct Materials {
  std::uint32_t tile, accent, grout, floor, wall, ceiling, enamel, chrome, mirror, glass, oak, stone, white, towel,
      striped, mat, bristle, wire, bottle, blue, green, amber, rose, duck, beak, black, leaf, lamp, water;
};
Materials add_materials(Scene& scene);

/// Makes a vessel as a smooth surface through rings (half length, half depth, height), from the outer foot over the rim
/// to the inner bottom. `square` selects rounded rectangles instead of ellipses.
Mesh make_vessel(std::string name, std::span<const glm::vec3> rings, bool square, std::uint32_t round,
                 std::uint32_t steps);

void add_walls(Scene& scene, const Materials& materials, const Detail& detail);
void add_tub(Scene& scene, const Materials& materials, const Detail& detail);
void add_vanity(Scene& scene, const Materials& materials, const Detail& detail);
void add_basin(Scene& scene, const Materials& materials, const Detail& detail);
void add_mirror(Scene& scene, const Materials& materials, const Detail& detail);
void add_toilet(Scene& scene, const Materials& materials, const Detail& detail);
void add_shower(Scene& scene, const Materials& materials, const Detail& detail);
void add_towels(Scene& scene, const Materials& materials, const Detail& detail);
void add_mat(Scene& scene, const Materials& materials, const Detail& detail);
void add_baskets(Scene& scene, const Materials& materials, const Detail& detail);
void add_toiletries(Scene& scene, const Materials& materials, const Detail& detail);

}  // namespace traces::bathroom
