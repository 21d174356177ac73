#pragma once
#include <cstdint>
#include <string>

#include "traces/scene/scene.h"

namespace traces::forest {

// Fine textures of high contrast, tileable unless stated otherwise.

/// Fallen leaves on top of each other on dark soil.
Texture litter_texture(std::string name, std::uint32_t leaves, std::uint32_t seed);
/// Rock below, moss above: v runs from the foot of a stone to its top.
Texture mossy_texture(std::string name, const glm::vec3& rock, std::uint32_t seed);
/// White flecks on a cap; u runs round, v from the rim to the top.
Texture cap_texture(std::string name, const glm::vec3& colour, std::uint32_t seed);
Texture gills_texture(std::string name);
/// Fallow deer: white spots on the back, a light belly; u runs round from the side over the belly, v along.
Texture fur_texture(std::string name);

/// Layers of trunks in haze, foliage above and undergrowth below; v runs down. Repeats along u.
Texture deep_forest_texture(std::string name);

}  // namespace traces::forest
