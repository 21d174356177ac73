#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "traces/accel/bvh_config.h"
#include "traces/accel/node_format.h"
#include "traces/ray.h"
#include "traces/scene/scene.h"

namespace traces {

/// Inner node of the binary BVH, one 64-byte line: both child boxes and two links. The bounds of each axis are {lower
/// of child 0, lower of child 1, upper of child 0, upper of child 1}, so that four lanes test both boxes. In hybrid
/// numbers a bound is the whole number of a grid plane. node_format.h defines the bits and bytes of a node in the GPU's
/// memory.
struct alignas(64) NodeRecord {
  float x[4], y[4], z[4];
  std::uint32_t child[2];  ///< link words
  std::uint32_t spare[2];  ///< padding to one line
};
static_assert(sizeof(NodeRecord) == 64);

// A link word: 1 | triangles - 1 (3) | first triangle (28) for a leaf, 0 | node (31) for an inner node. Only the root
// of a one-leaf tree has a kNoChild link; its inverted box is never hit.
inline constexpr std::uint32_t kNoChild = 0x7fffffffU;
constexpr bool is_leaf(std::uint32_t link) { return (link >> 31) != 0; }
constexpr std::uint32_t leaf_link(std::uint32_t first, std::uint32_t count) {
  return (1U << 31) | ((count - 1) << 28) | first;
}
constexpr std::uint32_t leaf_first(std::uint32_t link) { return link & ((1U << 28) - 1); }
constexpr std::uint32_t leaf_count(std::uint32_t link) { return ((link >> 28) & 7U) + 1; }

// Marks a leaf that names an instance. No first triangle is large enough to set this bit. In the GPU's memory the level
// of the tree makes the difference instead.
inline constexpr std::uint32_t kInstanceBit = 1U << 27;
static_assert(kMaxTriangles <= kInstanceBit && kMaxInstances <= kMaxTriangles);
constexpr std::uint32_t instance_link(std::uint32_t instance) { return leaf_link(kInstanceBit | instance, 1); }
constexpr bool is_instance(std::uint32_t link) { return is_leaf(link) && (link & kInstanceBit) != 0; }
constexpr std::uint32_t link_instance(std::uint32_t link) { return leaf_first(link) & (kInstanceBit - 1); }

/// Bit of an object id: the instance is in focus.
inline constexpr std::uint32_t kFocusObject = 1U << 30;

/// An instance of a mesh, one line. Traversal units read it before they enter the mesh's tree; kernels read it for
/// hits. The rows are the matrix from world to mesh space; its transposed upper left part carries normals to the world.
struct alignas(64) InstanceRecord {
  float to_object[3][4];
  std::uint32_t root;    ///< root node of the mesh's tree
  std::uint32_t object;  ///< as in TriangleRecord
  float handedness;      ///< -1 if the instance is mirrored, else 1
  float volume;          ///< volume scale: the absolute determinant of the matrix to the world
};
static_assert(sizeof(InstanceRecord) == 64);

// Culled faces in TriangleRecord::material: a ray that sees the corners in that order passes through. The first phase
// of the intersection test decides by the sign of the plane's slope along the ray.
inline constexpr std::uint32_t kNoClockwise = 1U << 29, kNoCounterClockwise = 1U << 28;

/// Triangle for the intersection unit: 48 bytes, three vertices and the labels that a hit copies.
struct TriangleRecord {
  glm::vec3 v0, v1, v2;
  std::uint32_t object;    ///< object id: index of the instance, with kFocusObject above it; 0 in two levels, where
                           ///< InstanceRecord has it
  std::uint32_t material;  ///< material index, with the culled faces and the flags of ray.h above it
  std::uint32_t source;    ///< triangle's index before leaf order: over all instances, or in two levels within its mesh
  std::uint32_t hit_flags() const { return material & ~kTriangleMask; }
};
static_assert(sizeof(TriangleRecord) == 48);

/// Shading attributes, 64 bytes per triangle, read through the SRP's data cache; same index as the triangle record.
struct AttributeRecord {
  /// Shading normals in world space; in two levels, in the mesh's space. With mip maps a normal's length is the texture
  /// density of the triangle: the root of its area in texture coordinates over that in space, kLeastDensity to
  /// kMostDensity. Otherwise normals are unit vectors.
  glm::vec3 normal[3];
  glm::vec2 uv[3];
  std::uint32_t material;
};
static_assert(sizeof(AttributeRecord) == 64);

inline constexpr float kLeastDensity = 0x1p-20F, kMostDensity = 0x1p20F;

/// More vertex data for materials with kVertexed, 64 bytes per triangle, same index; absent if no material needs it.
struct VertexRecord {
  glm::vec2 uv[3];             ///< Mesh::second_uvs
  std::uint32_t colour[3][2];  ///< RGBA, 16 bits per channel, linear, R lowest
  std::uint32_t tangent[3];    ///< world space x, y, z and the bitangent's sign, one byte each: 128 + 127 * value, x
                               ///< lowest
  std::uint32_t spare;         ///< padding to one line
};
static_assert(sizeof(VertexRecord) == 64);

/// Flags of MaterialRecord::flags. Each flag of the first two groups has an item list, which an inspector fills.
enum MaterialFlag : std::uint32_t {
  kTextured = 1,        ///< a base texture multiplies the diffuse colour and has no other use
  kDiffuse = 1U << 1,   ///< a metal_rough texture decides per texel
  kMirror = 1U << 2,    ///< a metal_rough texture decides per texel
  kGlass = 1U << 3,     ///< some light passes through the surface
  kEmissive = 1U << 4,  ///< emission without a texture
  kVertexed = 1U << 5,  ///< needs vertex colours, second texture coordinates or tangents
  kBased = 1U << 6,     ///< has a base texture that kTextured does not cover
  kPhysical = 1U << 7,  ///< has a metal_rough texture
  kBumped = 1U << 8,    ///< has a normal texture
  kAbsorbing = 1U << 9,
  kBlended = 1U << 10,      ///< Material::Alpha::kBlend
  kGlowing = 1U << 11,      ///< has an emission texture
  kOccluded = 1U << 12,     ///< has an occlusion texture
  kMasked = 1U << 13,       ///< Material::Alpha::kMask
  kSingleSided = 1U << 14,  ///< rays pass through back faces
  // Textures that use the second texture coordinates.
  kBaseSecond = 1U << 16,
  kMetalRoughSecond = 1U << 17,
  kNormalSecond = 1U << 18,
  kOcclusionSecond = 1U << 19,
  kEmissionSecond = 1U << 20,
};
inline constexpr std::uint32_t kDetailStreams = 0x1fe0U;  ///< flags whose kernels run only if some material has the
                                                          ///< flag

/// Material data that every hit reads: 64 bytes, all colours linear. With a metal_rough texture, `mirrored` is 0 and
/// the other shares are as for a pure dielectric.
struct MaterialRecord {
  glm::vec3 base_colour;
  float diffuse_share;  ///< (1 - mirror) (1 - transmission)
  glm::vec3 mirrored;   ///< mirror * mirror_tint
  float entering;       ///< (1 - mirror) transmission, split later by Fresnel's law
  glm::vec3 emission;
  float ior;
  std::uint32_t base_texture;  ///< kNoTexture or an index into textures
  std::uint32_t flags;         ///< MaterialFlag
  float opacity;               ///< 1 if the material ignores alpha
  float alpha_cutoff;          ///< used with kMasked, otherwise 0
};
static_assert(sizeof(MaterialRecord) == 64);

/// Further material data, 64 bytes per material; absent if no material needs it.
struct MaterialDetailRecord {
  glm::vec3 emission;
  std::uint32_t normal_texture;
  glm::vec3 absorption;
  std::uint32_t occlusion_texture;
  std::uint32_t metal_rough_texture, emission_texture;
  float normal_scale, occlusion_strength;
  float metallic, roughness, dielectric, coat;
};
static_assert(sizeof(MaterialDetailRecord) == 64);

/// Byte addresses of all arrays in the GPU's memory, 64-byte aligned. Textures are RGBA8 in tiles of 4 x 4 texels, one
/// line per tile, stored row by row.
struct Layout {
  std::uint64_t nodes = 0, instances = 0, triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::uint32_t node_bytes = sizeof(NodeRecord);
  /// The record indices of each inner node's children, if records hold single boxes; otherwise empty, and a node's
  /// record has the node's index.
  std::vector<std::array<std::uint32_t, 2>> single_boxes;
  std::uint32_t triangle_bytes = sizeof(TriangleRecord);
  /// Address of the label words of triangles, if TriangleRecord is stored as vertices and labels apart.
  std::uint64_t labels = 0;
  struct TextureAt {
    std::uint64_t base = 0;
    std::uint32_t tiles_per_row = 0;
  };
  std::vector<TextureAt> textures;
  std::uint64_t frame_buffer = 0;
  std::uint64_t end = 0;  ///< first byte after the scene, where the frame buffer begins

  static constexpr std::uint32_t kVerticesBytes = 36;
  static constexpr std::uint32_t kLabelBytes = sizeof(TriangleRecord) - kVerticesBytes;

  /// Returns the address of tree record `i`.
  std::uint64_t node_at(std::uint32_t i) const { return nodes + std::uint64_t{i} * node_bytes; }
  std::uint64_t instance_at(std::uint32_t i) const { return instances + std::uint64_t{i} * sizeof(InstanceRecord); }
  std::uint64_t triangle_at(std::uint32_t i) const { return triangles + std::uint64_t{i} * triangle_bytes; }
  bool has_labels() const { return triangle_bytes == kVerticesBytes; }
  std::uint64_t label_at(std::uint32_t i) const { return labels + std::uint64_t{i} * kLabelBytes; }
  std::uint64_t attributes_at(std::uint32_t i) const { return attributes + std::uint64_t{i} * sizeof(AttributeRecord); }
  std::uint64_t material_at(std::uint32_t i) const { return materials + std::uint64_t{i} * sizeof(MaterialRecord); }
  std::uint64_t vertices_at(std::uint32_t i) const { return vertices + std::uint64_t{i} * sizeof(VertexRecord); }
  std::uint64_t detail_at(std::uint32_t i) const { return details + std::uint64_t{i} * sizeof(MaterialDetailRecord); }
  /// Returns the address of the 4 x 4 tile that contains texel (x, y).
  std::uint64_t texel_tile_at(std::uint32_t texture, std::uint32_t x, std::uint32_t y) const {
    const TextureAt& t = textures[texture];
    return t.base + (std::uint64_t{y / 4} * t.tiles_per_row + x / 4) * 64;
  }
};

/// Whether textures have mip levels in memory.
enum class MipMaps : std::uint8_t { kOff, kOn };
constexpr std::array<std::string_view, 2> names_of(MipMaps) { return {"off", "on"}; }
/// Limit of the mip levels of all textures together; a footprint stores a level's number in 16 bits.
inline constexpr std::uint32_t kMostMipLevels = 1U << 16;

/// Numbers of records and sizes of textures. Together with the tree they determine the layout.
struct ImageCounts {
  std::uint64_t triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::vector<std::array<std::uint32_t, 2>> textures;  ///< width and height
  std::uint64_t instances = 0, trees = 0;              ///< two levels: instances, and trees below the tree of instances
  friend bool operator==(const ImageCounts&, const ImageCounts&) = default;
};

/// The part of the arrays that belongs to one tree over triangles.
struct ObjectTree {
  std::uint32_t mesh = 0;
  std::uint32_t only = kNone;  ///< the only instance that uses the tree, if it cannot be shared
  bool in_world = false;       ///< its triangles are in world space, because the instance's matrix has no inverse
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_node = 0;  ///< root node; a tree ends where the next one begins
};

/// The scene as stored in the GPU's memory. It has one of two forms: all instances flattened into world space under one
/// tree, or two levels (two_level.h), a tree over instances followed by one tree per mesh in its own space.
struct MemoryImage {
  std::vector<NodeRecord> nodes;          ///< node 0 is the root
  std::vector<InstanceRecord> instances;  ///< two levels: in the order of Scene::instances; otherwise empty
  std::vector<ObjectTree> trees;          ///< two levels, host only; shared trees first
  std::vector<std::uint32_t> tree_of;     ///< tree of each instance; kNone if the instance has no triangles
  std::vector<TriangleRecord> triangles;  ///< in leaf order
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< empty if no material needs them
  std::vector<MaterialRecord> materials;
  std::vector<MaterialDetailRecord> details;  ///< empty if no material needs them
  std::vector<Texture> textures;              ///< texels decoded row by row; only their addresses are tiled
  /// With mip maps, the number of levels for each texture that is a first level, and 0 for the others; otherwise empty.
  /// Each level is a texture of its own, stored after the previous level. Materials name the first level.
  std::vector<std::uint32_t> mip_levels;
  std::uint32_t white = kNoTexture;  ///< index of a white texel, for flagged triangles without a base texture
  std::vector<Light> lights;
  glm::vec3 background{0}, ambient{0};
  glm::vec3 lower{0}, upper{0};  ///< bounds of all triangles
  std::optional<BoxGrid> grid;   ///< grid of the nodes' boxes, in hybrid numbers
  Layout layout;
  bool has_levels() const { return !instances.empty(); }
  bool has_mip_maps() const { return !mip_levels.empty(); }
  bool has_single_sided() const;  ///< True if rays pass through the back faces of some material.
  std::uint64_t node_array_bytes() const;
  float diagonal() const;
};

struct BvhConfig;

ImageCounts counts_of(const MemoryImage& image);

/// Lays out all arrays one after the other, each beginning on a new line.
Layout layout_of(const ImageCounts& counts, const std::vector<NodeRecord>& nodes, const BvhConfig& config);

/// Returns the parent of each inner node; a root is its own parent. In two levels, the parent node of each instance
/// follows.
std::vector<std::uint32_t> parents_of(const MemoryImage& image);

}  // namespace traces
