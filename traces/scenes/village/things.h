#pragma once
#include <cstdint>

#include "traces/scene/scene.h"
#include "traces/scenes/village/houses.h"

namespace traces::village {

/// Makes a dry stone wall along x, `length` metres long, 1 m high, with its middle at the origin.
Mesh make_stone_wall(float length, float detail, std::uint32_t seed);
/// Makes a fence of posts and rails, `length` metres along x.
Mesh make_fence(float length);

/// Adds a round fountain with a column in its middle. The water is a mesh of its own.
Building add_fountain(Scene& scene, std::uint32_t stone, std::uint32_t water, float detail);

/// Adds the windmill without its sails, whose hub is at kHub; they turn about +z.
Building add_mill(Scene& scene, const HouseMaterials& paints, std::uint32_t cap, float detail);
inline constexpr glm::vec3 kHub{0, 11.6F, 3.6F};
Building add_sails(Scene& scene, std::uint32_t timber, std::uint32_t cloth);

/// Adds a farm cart with two wheels, loaded with hay; its shafts point towards +x. The wheel is a mesh of its own, to
/// be shown at kWheels and mirrored, turning about z.
Building add_cart(Scene& scene, std::uint32_t timber, std::uint32_t hay, std::uint32_t iron);
Mesh make_wheel();
inline constexpr float kWheelRadius = 0.62F, kWheelSide = 0.85F;

}  // namespace traces::village
