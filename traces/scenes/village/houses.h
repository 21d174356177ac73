#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "traces/scene/scene.h"

namespace traces::village {

/// Indices of a house's materials in Scene::materials.
struct HouseMaterials {
  std::uint32_t wall, roof, timber, shutter, glass, door, stone;
};

/// Shape of a house. Lengths are in metres; the ridge runs along z, the door is in the wall at +x.
struct HouseShape {
  float width = 7, length = 9, eaves = 3, ridge = 6.5F;
  std::uint32_t storeys = 1;
  bool timbered = false, shutters = true, barn = false;
  std::uint32_t dormers = 0;  ///< number of dormers on each side of the roof
  float chimney = 0.3F;       ///< position of the chimney along the ridge, -0.5 to 0.5
};

/// Indices of the meshes of a building, one per material; each gets one instance wherever the building is shown.
using Building = std::vector<std::uint32_t>;

Building add_house(Scene& scene, const std::string& name, const HouseShape& shape, const HouseMaterials& paints,
                   float detail);
Building add_church(Scene& scene, const HouseMaterials& paints, std::uint32_t white, std::uint32_t gold, float detail);

/// The meshes of a building under construction, one per material.
class Parts {
 public:
  void add_piece(std::uint32_t material, const Mesh& piece, const glm::mat4& at = glm::mat4(1));
  /// Adds a box in the coordinate system `at`.
  void add_box(std::uint32_t material, const glm::mat4& at, const glm::vec3& lower, const glm::vec3& upper);
  /// Adds a parallelogram in the coordinate system `at`, with texture coordinates in metres.
  void add_panel(std::uint32_t material, const glm::mat4& at, const glm::vec3& corner, const glm::vec3& u,
                 const glm::vec3& v);
  Building add_meshes_to_scene(Scene& scene, const std::string& name) const;

 private:
  std::vector<std::pair<std::uint32_t, Mesh>> meshes_;
};

/// Adds the walls of a house with gables, from 1 m below the ground.
void add_walls(Parts& parts, std::uint32_t wall, const HouseShape& shape);
/// Adds a roof of tiles in relief on both sides, with boards along its edges.
void add_roof(Parts& parts, std::uint32_t roof, std::uint32_t timber, const HouseShape& shape, float detail);

/// Returns the coordinate system of a house wall: x right, y up, z outwards. The wall faces +x, rotated by `turns`
/// about y. Its origin is at distance `out` from the house's middle, `aside` to the right, at height `up`.
glm::mat4 wall_frame(double turns, float out, float aside = 0, float up = 0);

/// Makes a pointed or round-headed opening in the coordinates of a wall, with the middle of its foot at the origin.
Mesh make_arch(float width, float height, float depth, std::uint32_t steps);

}  // namespace traces::village
