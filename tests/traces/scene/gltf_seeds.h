#pragma once
#include <string>
#include <vector>

#include "tests/traces/scene/tiny_gltf_file.h"

namespace test {

/// A bent patch of 4 x 4 squares, 32 triangles and 25 vertices, as plain arrays.
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
/// Returns small files that together use everything the loader reads, to be mutated.
std::vector<Seed> seeds();

}  // namespace test
