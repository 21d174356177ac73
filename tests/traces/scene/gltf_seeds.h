#pragma once
#include <string>
#include <vector>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// A curved surface of 4 x 4 squares as plain arrays: 32 triangles and 25 vertices.
struct Patch {
  std::vector<float> positions, normals, uvs;
  std::vector<std::uint32_t> indices;
  std::size_t vertices() const { return positions.size() / 3; }
};
Patch make_patch();

// Files of each kind that contain the patch.
TinyGltf plain_patch();
TinyGltf draco_patch(bool edgebreaker);
TinyGltf meshopt_patch();  ///< with a fallback buffer, as gltfpack writes it

struct Seed {
  std::string name;
  TinyGltf file;
};
/// Returns small glTF files, as seeds for mutation, that together use every feature of the loader.
std::vector<Seed> seeds();

}  // namespace test
