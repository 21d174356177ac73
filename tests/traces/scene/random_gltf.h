#pragma once
#include <cstdint>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// Returns a small random glTF file, determined by `seed`. It may have nodes with every kind of transform (flat,
/// mirrored, sheared, empty), meshes with and without each attribute and morph targets, skins that share joints or
/// roots, every material extension, textures, lights, cameras and animations. Some values are legal but unusual. Others
/// are wrong but accepted: normals of any length, key times that do not ascend, rotations that are not of unit length.
TinyGltf random_gltf(std::uint64_t seed);

}  // namespace test
