#pragma once
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "traces/scene/scene.h"

namespace traces {

/// Inner node of the 2-wide BVH, one 64-byte line: both child boxes and two links. Bounds are kept axis by axis as
/// {lower of child 0, lower of child 1, upper of child 0, upper of child 1}, so that four lanes test both boxes.
struct alignas(64) NodeRecord {
  float x[4], y[4], z[4];
  std::uint32_t child[2];  ///< link words
  std::uint32_t spare[2];  ///< keeps the record one line
};
static_assert(sizeof(NodeRecord) == 64);

// A link word: 1 | triangles - 1 (3) | first triangle (28) for a leaf, 0 | node (31) for an inner node. kNoChild, which
// only the root of a one-leaf tree has, is never hit: its box is inverted.
inline constexpr std::uint32_t kNoChild = 0x7fffffffU;
constexpr bool is_leaf(std::uint32_t link) { return (link >> 31) != 0; }
constexpr std::uint32_t leaf_link(std::uint32_t first, std::uint32_t count) {
  return (1U << 31) | ((count - 1) << 28) | first;
}
constexpr std::uint32_t leaf_first(std::uint32_t link) { return link & ((1U << 28) - 1); }
constexpr std::uint32_t leaf_count(std::uint32_t link) { return ((link >> 28) & 7U) + 1; }

/// What the intersection unit reads: 48 bytes, three vertices and what a hit must say without another fetch.
struct TriangleRecord {
  glm::vec3 v0, v1, v2;
  std::uint32_t object;  ///< object id: index of the instance
  std::uint32_t material;
  std::uint32_t source;  ///< index of the triangle before leaf order (instance by instance)
};
static_assert(sizeof(TriangleRecord) == 48);

/// What shading reads through the SRP's data cache: 64 bytes per triangle, same index as the triangle record.
struct AttributeRecord {
  glm::vec3 normal[3];  ///< unit shading normals in world space
  glm::vec2 uv[3];
  std::uint32_t material;
};
static_assert(sizeof(AttributeRecord) == 64);

/// 64 bytes per material, all colours linear.
struct MaterialRecord {
  glm::vec3 base_colour;
  float mirror;
  glm::vec3 mirror_tint;
  float transmission;
  glm::vec3 emission;
  float ior;
  std::uint32_t base_texture;  ///< kNoTexture or an index into textures
  std::uint32_t spare[3];
};
static_assert(sizeof(MaterialRecord) == 64);

/// Where everything lies in the GPU's memory: byte addresses, 64-byte aligned. Textures are stored as RGBA8 in tiles of
/// 4 x 4 texels, one line each, tiles row by row.
struct Layout {
  std::uint64_t nodes = 0, triangles = 0, attributes = 0, materials = 0;
  struct TextureAt {
    std::uint64_t base = 0;
    std::uint32_t tiles_per_row = 0;
  };
  std::vector<TextureAt> textures;
  std::uint64_t frame_buffer = 0;
  std::uint64_t end = 0;  ///< first byte behind the scene, where the frame buffer begins

  std::uint64_t node_at(std::uint32_t i) const { return nodes + std::uint64_t{i} * sizeof(NodeRecord); }
  std::uint64_t triangle_at(std::uint32_t i) const { return triangles + std::uint64_t{i} * sizeof(TriangleRecord); }
  std::uint64_t attributes_at(std::uint32_t i) const { return attributes + std::uint64_t{i} * sizeof(AttributeRecord); }
  std::uint64_t material_at(std::uint32_t i) const { return materials + std::uint64_t{i} * sizeof(MaterialRecord); }
  /// Address of the 4 x 4 tile that holds texel (x, y).
  std::uint64_t texel_tile_at(std::uint32_t texture, std::uint32_t x, std::uint32_t y) const {
    const TextureAt& t = textures[texture];
    return t.base + (std::uint64_t{y / 4} * t.tiles_per_row + x / 4) * 64;
  }
};

/// The scene as the GPU's memory holds it, instances flattened into world space.
struct MemoryImage {
  std::vector<NodeRecord> nodes;          ///< node 0 is the root
  std::vector<TriangleRecord> triangles;  ///< in leaf order
  std::vector<AttributeRecord> attributes;
  std::vector<MaterialRecord> materials;
  std::vector<Texture> textures;  ///< texels decoded row by row; only their addresses are tiled
  std::vector<Light> lights;
  glm::vec3 background{0}, ambient{0};
  glm::vec3 lower{0}, upper{0};  ///< bounds of all triangles
  Layout layout;
  float diagonal() const;
};

/// The inner node above each inner node; the root is its own.
std::vector<std::uint32_t> parents_of(const MemoryImage& image);

}  // namespace traces
