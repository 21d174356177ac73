#pragma once
#include <cstdint>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// A small file drawn from the seed: nodes with every kind of transform (flat, mirrored, sheared by their parents,
/// empty), meshes with and without each attribute and morph targets, skins that share joints and roots or not, every
/// material extension, textures, lights, cameras and animations. Some values are legal but odd, others are wrong but
/// read nevertheless: normals of any length, key times that do not grow, rotations that are not of unit length.
TinyGltf random_gltf(std::uint64_t seed);

}  // namespace test
