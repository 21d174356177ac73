#pragma once
#include <cstdint>
#include <string>

#include "traces/scene/scene.h"

namespace traces::village {

/// Returns the height of the village's land in metres: flat at the houses, a hill for the mill, far hills on all sides.
float ground_height(float x, float z);
inline glm::vec3 point_on_ground(float x, float z, float above = 0) { return {x, ground_height(x, z) + above, z}; }

/// Returns x of the middle of the village street, which runs from z = kStreetEnd to kStreetStart, to the church.
float street_x(float z);
inline constexpr float kStreetStart = 92, kStreetEnd = -40;

inline constexpr glm::vec2 kChurch{-8, -64}, kMill{-74, -66}, kSquare{-1, -6};

/// Makes land between two circles about the origin. Texture coordinates are the position in metres divided by
/// `texture_size`.
Mesh make_land(std::string name, float from, float to, std::uint32_t round, std::uint32_t rings, float texture_size);

/// Makes a rotated rectangle of land of `size` about `middle`, `above` the ground.
Mesh make_field(std::string name, const glm::vec2& middle, const glm::vec2& size, double turns, float above, float cell,
                float texture_size);

/// Makes the village street, `width` wide, with the round square on it.
Mesh make_street(std::string name, float width, float cell, float texture_size);
Mesh make_square(std::string name, float radius, std::uint32_t round, float texture_size);

/// Returns a texture of fields and woods as seen from afar.
Texture countryside_texture(std::string name, std::uint32_t size);
Texture haze_texture(std::string name, std::uint32_t size);
Texture grass_texture(std::string name);
Texture cobble_texture(std::string name, std::uint32_t stones);
/// Returns a texture of rows of a crop with soil between them.
Texture crop_texture(std::string name, const glm::vec3& crop, const glm::vec3& soil, std::uint32_t rows,
                     std::uint32_t seed);

/// Adds trees, bushes and grass. Their leaves fill the scene up to `triangles` triangles.
void add_garden(Scene& scene, std::uint32_t triangles, float detail);

}  // namespace traces::village
