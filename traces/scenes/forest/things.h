#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "traces/scene/scene.h"

namespace traces::forest {

/// Meshes with their materials that make one thing together.
using Pieces = std::vector<std::pair<Mesh, std::uint32_t>>;

/// A fern of drooping fronds with leaflets on both sides, `reach` long.
Mesh make_fern(std::uint32_t fronds, std::uint32_t pairs, float reach, std::uint64_t seed);

/// A mushroom of `height` metres. `bell`: 0 a flat cap, 1 a pointed one.
Pieces make_mushroom(float height, float bell, std::uint32_t round, std::uint32_t cap, std::uint32_t gills,
                     std::uint32_t stem);

/// A deer with antlers, 1 m high at the shoulder, that stands along +x.
Pieces make_deer(std::uint32_t sides, std::uint32_t fur, std::uint32_t horn, std::uint32_t dark);

/// A bench of planks on two trestles, 1.7 m along x, to be sat on facing +z.
Pieces make_bench(std::uint32_t wood, std::uint32_t dark);
/// A lantern that stands, 0.38 m high; its flame is a lamp.
Pieces make_lantern(std::uint32_t iron, std::uint32_t flame);

/// A fallen trunk along x with a broken end and stubs.
Mesh make_log(float length, float radius, std::uint32_t sides, std::uint32_t seed);
/// Roots that run down and out from a trunk of that radius.
Mesh make_roots(float radius, std::uint32_t sides, std::uint64_t seed);
/// Fallen leaves on flat ground within `radius`.
Mesh make_litter(float radius, std::uint32_t leaves, std::uint64_t seed);

}  // namespace traces::forest
