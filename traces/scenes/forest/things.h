#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "traces/scene/scene.h"

namespace traces::forest {

/// Meshes with their materials, which together make one object.
using Pieces = std::vector<std::pair<Mesh, std::uint32_t>>;

/// Makes a fern of drooping fronds with `pairs` pairs of leaflets each. Fronds are `reach` metres long.
Mesh make_fern(std::uint32_t fronds, std::uint32_t pairs, float reach, std::uint64_t seed);

/// Makes a mushroom of `height` metres. `bell` is 0 for a flat cap, 1 for a pointed one.
Pieces make_mushroom(float height, float bell, std::uint32_t round, std::uint32_t cap, std::uint32_t gills,
                     std::uint32_t stem);

/// Makes a deer with antlers, 1 m high at the shoulder, facing +x.
Pieces make_deer(std::uint32_t sides, std::uint32_t fur, std::uint32_t horn, std::uint32_t dark);

/// Makes a bench of planks on two trestles, 1.7 m along x; it faces +z.
Pieces make_bench(std::uint32_t wood, std::uint32_t dark);
/// Makes a lantern, 0.38 m high; its flame is a lamp.
Pieces make_lantern(std::uint32_t iron, std::uint32_t flame);

/// Makes a fallen trunk along x with a broken end and stubs of branches.
Mesh make_log(float length, float radius, std::uint32_t sides, std::uint32_t seed);
/// Makes the roots of a tree, which run down and out from a trunk of the given radius.
Mesh make_roots(float radius, std::uint32_t sides, std::uint64_t seed);
/// Makes fallen leaves on flat ground within `radius` metres of the origin.
Mesh make_litter(float radius, std::uint32_t leaves, std::uint64_t seed);

// Fine textures of high contrast. They can be tiled unless stated otherwise.

/// Returns a texture of fallen leaves on dark soil.
Texture litter_texture(std::string name, std::uint32_t leaves, std::uint32_t seed);
/// Returns a texture of stone with rock below and moss above; v runs from the foot of the stone to its top.
Texture mossy_texture(std::string name, const glm::vec3& rock, std::uint32_t seed);
/// Returns a texture of a mushroom's cap with white flecks; u runs around, v from the rim to the top.
Texture cap_texture(std::string name, const glm::vec3& colour, std::uint32_t seed);
Texture gills_texture(std::string name);
/// Returns a texture of a fallow deer: white spots on the back, a light belly. u runs around from the side over the
/// belly, v along.
Texture fur_texture(std::string name);

/// Returns a panorama of trunks in haze, with foliage above and undergrowth below; v runs down. It repeats along u.
Texture deep_forest_texture(std::string name);

}  // namespace traces::forest
