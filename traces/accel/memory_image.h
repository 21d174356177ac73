#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "traces/accel/build/build_statistics.h"
#include "traces/accel/bvh_config.h"
#include "traces/accel/node_format.h"
#include "traces/ray.h"
#include "traces/scene/bounds.h"
#include "traces/scene/scene.h"

namespace traces {

/// Inner node of the binary BVH, one 64-byte line: both child boxes and two links. The bounds of each axis are {lower
/// of child 0, lower of child 1, upper of child 0, upper of child 1}, so that four lanes test both boxes. In hybrid
/// numbers a bound is the whole number of a grid plane. node_format.h defines the node's bits in the GPU's memory.
struct alignas(64) NodeRecord {
  float x[4], y[4], z[4];
  std::uint32_t child[2];  ///< link words of the two children
  std::uint32_t spare[2];  ///< pads the node to one line
};
static_assert(sizeof(NodeRecord) == 64);

/// Inner node of a wide BVH with up to kMaxWidth children, as traversal sees it. The planes are floats in the numbers
/// that box tests use: for quantised formats the results of the decoder, for hybrid numbers whole grid planes.
/// wide_format.h defines the node's bits in the GPU's memory.
///
/// 1. Children are in slots. A slot without a child has a kNoChild link and an inverted box, which is never hit.
/// 2. The inner children of a node have consecutive numbers in slot order, all larger than the node's.
/// 3. The triangles of a node's leaves are consecutive in slot order.
struct alignas(32) WideNode {
  float planes[3][2][kMaxWidth];   ///< for each axis: the lower planes of all slots, then the upper planes
  std::uint32_t child[kMaxWidth];  ///< link words
};
static_assert(sizeof(WideNode) == 224);

// A link word names a child. A leaf is 1 | triangles - 1 (3 bits) | first triangle (28), a node is 0 | node (31). Only
// the root of a one-leaf tree has a kNoChild link; its inverted box is never hit.
inline constexpr std::uint32_t kNoChild = 0x7fffffffU;
constexpr bool is_leaf(std::uint32_t link) { return (link >> 31) != 0; }
constexpr std::uint32_t leaf_link(std::uint32_t first, std::uint32_t count) {
  return (1U << 31) | ((count - 1) << 28) | first;
}
constexpr std::uint32_t leaf_first(std::uint32_t link) { return link & ((1U << 28) - 1); }
constexpr std::uint32_t leaf_count(std::uint32_t link) { return ((link >> 28) & 7U) + 1; }

// Bit of a link word to a leaf that names an instance. No first triangle is large enough to set it. The GPU's memory
// has no such bit, because the tree over instances has only instance leaves.
inline constexpr std::uint32_t kInstanceBit = 1U << 27;
static_assert(kMaxTriangles <= kInstanceBit && kMaxInstances <= kMaxTriangles);
constexpr std::uint32_t instance_link(std::uint32_t instance) { return leaf_link(kInstanceBit | instance, 1); }
constexpr bool is_instance(std::uint32_t link) { return is_leaf(link) && (link & kInstanceBit) != 0; }
constexpr std::uint32_t link_instance(std::uint32_t link) { return leaf_first(link) & (kInstanceBit - 1); }

/// Bit of an object id that marks an object of interest (Instance::focus).
inline constexpr std::uint32_t kFocusObject = 1U << 30;

/// The record of an instance of a mesh, one line. Traversal units read the record before they enter the mesh's tree;
/// kernels read it for hits. The rows are the matrix from world to mesh space; its transposed upper left part
/// transforms normals to the world.
struct alignas(64) InstanceRecord {
  float to_object[3][4];
  std::uint32_t root;    ///< root node of the tree of the mesh
  std::uint32_t object;  ///< object id of the instance, as in TriangleRecord
  float handedness;      ///< -1 if the instance is mirrored, otherwise 1
  float volume;          ///< factor by which volumes grow: the absolute determinant of the matrix to the world
};
static_assert(sizeof(InstanceRecord) == 64);

// Culled faces in TriangleRecord::material: a ray that sees the corners in that order passes through. The first phase
// of the intersection test decides by the sign of the slope of the triangle's plane along the ray.
inline constexpr std::uint32_t kNoClockwise = 1U << 29, kNoCounterClockwise = 1U << 28;

/// The record of a triangle for the intersection unit, 48 bytes: three vertices, and the labels (object, material,
/// source) that a hit copies.
struct TriangleRecord {
  glm::vec3 v0, v1, v2;
  std::uint32_t object;    ///< object id and kFocusObject; 0 in a two-level BVH (then in InstanceRecord)
  std::uint32_t material;  ///< material index in the low bits; culled faces and the flags of ray.h above
  std::uint32_t source;    ///< number of the triangle in input order: in all instances; in a two-level BVH, in its mesh
  std::uint32_t hit_flags() const { return material & ~kTriangleMask; }
};
static_assert(sizeof(TriangleRecord) == 48);

/// Shading attributes of a triangle, 64 bytes, read through the SRP's data cache; same index as the triangle record.
struct AttributeRecord {
  /// Shading normals in world space or, for a two-level BVH, in the mesh's space. With mip maps the length of a normal
  /// is the texture density of the triangle, kLeastDensity to kMostDensity: the square root of its area in texture
  /// coordinates divided by its area in space. Otherwise normals are unit vectors.
  glm::vec3 normal[3];
  glm::vec2 uv[3];
  std::uint32_t material;
};
static_assert(sizeof(AttributeRecord) == 64);

inline constexpr float kLeastDensity = 0x1p-20F, kMostDensity = 0x1p20F;

/// Further vertex data of a triangle for materials with kVertexed, 64 bytes. The index is that of the triangle record.
/// The array is empty if no material needs it.
struct VertexRecord {
  glm::vec2 uv[3];             ///< second texture coordinates (Mesh::second_uvs)
  std::uint32_t colour[3][2];  ///< linear RGBA, 16 bits per channel, R lowest
  std::uint32_t tangent[3];    ///< tangent's x (lowest), y, z in world space, bitangent's sign; bytes 128 + 127 * value
  std::uint32_t spare;         ///< pads the record to one line
};
static_assert(sizeof(VertexRecord) == 64);

/// Flags of MaterialRecord::flags. For each flag up to kOccluded, a kernel lists the surfaces that have it.
enum MaterialFlag : std::uint32_t {
  kTextured = 1,        ///< has a base texture that only multiplies the diffuse colour
  kDiffuse = 1U << 1,   ///< scatters light diffusely; with a metal_rough texture each texel decides
  kMirror = 1U << 2,    ///< mirrors light; with a metal_rough texture each texel decides
  kGlass = 1U << 3,     ///< transmits some light
  kEmissive = 1U << 4,  ///< emits light without a texture
  kVertexed = 1U << 5,  ///< needs vertex records: colours, second texture coordinates or tangents
  kBased = 1U << 6,     ///< has a base texture that kTextured does not cover
  kPhysical = 1U << 7,  ///< has a metal_rough texture
  kBumped = 1U << 8,    ///< has a normal texture
  kAbsorbing = 1U << 9,
  kBlended = 1U << 10,      ///< blended by alpha (Material::Alpha::kBlend)
  kGlowing = 1U << 11,      ///< has an emission texture
  kOccluded = 1U << 12,     ///< has an occlusion texture
  kMasked = 1U << 13,       ///< tested for alpha (Material::Alpha::kMask)
  kSingleSided = 1U << 14,  ///< rays pass through the back faces
  // Flags of textures that use the second texture coordinates.
  kBaseSecond = 1U << 16,
  kMetalRoughSecond = 1U << 17,
  kNormalSecond = 1U << 18,
  kOcclusionSecond = 1U << 19,
  kEmissionSecond = 1U << 20,
};
// Bits of MaterialRecord::flags from kRoughnessShift on: the GGX roughness of mirrored light in steps of 1 / 255, or 0
// for smooth mirrors. Set only in images that are built with Roughness::kOn.
inline constexpr std::uint32_t kRoughnessShift = 24, kRoughnessMask = 0xffU << kRoughnessShift;
inline constexpr float kLeastRoughness = 0.1F;            ///< smoother surfaces are mirrors
inline constexpr std::uint32_t kDetailStreams = 0x1fe0U;  ///< flags whose kernels run only if a scene needs them

/// Material data that every hit reads, 64 bytes, all colours linear. With a metal_rough texture, `mirrored` is 0 and
/// the other fractions are those of a pure dielectric.
struct MaterialRecord {
  glm::vec3 base_colour;
  float diffuse_share;  ///< fraction of light that is scattered: (1 - mirror) (1 - transmission)
  glm::vec3 mirrored;   ///< fraction of light that is mirrored: mirror * mirror_tint
  float entering;       ///< fraction of light that Fresnel's law splits later: (1 - mirror) transmission
  glm::vec3 emission;
  float ior;
  std::uint32_t base_texture;  ///< index of the base texture, or kNoTexture
  std::uint32_t flags;         ///< material classes and other flags, as bits of MaterialFlag
  float opacity;               ///< alpha of the material; 1 if the material ignores alpha
  float alpha_cutoff;          ///< smallest alpha that is opaque in a kMasked material, otherwise 0
};
static_assert(sizeof(MaterialRecord) == 64);

/// Further data of a material, 64 bytes, for textures and absorption. The array is empty if no material needs it.
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
/// line per tile, and tiles are stored row by row.
struct Layout {
  std::uint64_t nodes = 0, instances = 0, triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::uint32_t node_bytes = sizeof(NodeRecord);
  /// If a BVH record holds a single box: the record indices of each inner node's children. Otherwise empty, and the
  /// index of a record is that of its node.
  std::vector<std::array<std::uint32_t, 2>> single_boxes;
  // Places of records that are not in the order of their numbers, in units of 16 bytes from the beginning of their
  // array; otherwise empty. In q8 all three arrays begin at `nodes`, because each node is followed by its leaves.
  std::vector<std::uint32_t> node_places, triangle_places, instance_places;
  std::uint32_t triangle_bytes = sizeof(TriangleRecord);  ///< size of a leaf record
  bool separate_labels = false;  ///< label words of triangles are in an array, not in leaf records
  std::uint64_t leaf_bytes = 0;  ///< bytes of all leaf records, without labels
  std::uint64_t tree_bytes = 0;  ///< bytes of all nodes, instances and leaf records
  /// Address of the triangles' label words, if they are stored apart from the vertices.
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

  /// Returns the address of BVH record `i`.
  std::uint64_t node_at(std::uint32_t i) const { return nodes + place_of(node_places, i, node_bytes); }
  std::uint64_t instance_at(std::uint32_t i) const {
    return instances + place_of(instance_places, i, sizeof(InstanceRecord));
  }
  /// Returns the address of the record that contains triangle `i`.
  std::uint64_t triangle_at(std::uint32_t i) const { return triangles + place_of(triangle_places, i, triangle_bytes); }
  bool has_labels() const { return separate_labels; }
  std::uint64_t label_at(std::uint32_t i) const { return labels + std::uint64_t{i} * kLabelBytes; }
  std::uint64_t attributes_at(std::uint32_t i) const { return attributes + std::uint64_t{i} * sizeof(AttributeRecord); }
  std::uint64_t material_at(std::uint32_t i) const { return materials + std::uint64_t{i} * sizeof(MaterialRecord); }
  std::uint64_t vertices_at(std::uint32_t i) const { return vertices + std::uint64_t{i} * sizeof(VertexRecord); }
  std::uint64_t detail_at(std::uint32_t i) const { return details + std::uint64_t{i} * sizeof(MaterialDetailRecord); }
  /// Returns the address of the tile of 4 x 4 texels that contains texel (x, y).
  std::uint64_t texel_tile_at(std::uint32_t texture, std::uint32_t x, std::uint32_t y) const {
    const TextureAt& t = textures[texture];
    return t.base + (std::uint64_t{y / 4} * t.tiles_per_row + x / 4) * 64;
  }

  static constexpr std::uint32_t kPlaceBytes = 16;

 private:
  static std::uint64_t place_of(const std::vector<std::uint32_t>& places, std::uint32_t i, std::uint32_t bytes) {
    return places.empty() ? std::uint64_t{i} * bytes : std::uint64_t{places[i]} * kPlaceBytes;
  }
};

/// Whether textures have mip levels in memory.
enum class MipMaps : std::uint8_t { kOff, kOn };
constexpr std::array<std::string_view, 2> names_of(MipMaps) { return {"off", "on"}; }
/// Whether materials have GGX roughness; otherwise all mirrors are smooth, and a rough surface mirrors less.
enum class Roughness : std::uint8_t { kOff, kOn };
/// Largest number of mip levels of all textures together: texture coordinate records have 16 bits for a level's number.
inline constexpr std::uint32_t kMostMipLevels = 1U << 16;

/// Numbers of records and sizes of textures of a scene. Together with the tree they determine the memory layout.
struct ImageCounts {
  std::uint64_t triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::vector<std::array<std::uint32_t, 2>> textures;  ///< width and height of each texture, in texels
  std::uint64_t instances = 0, trees = 0;  ///< in two levels: instances, and trees below the tree over instances
  friend bool operator==(const ImageCounts&, const ImageCounts&) = default;
};

/// Which nodes and triangles of the memory image belong to the tree of one mesh.
struct ObjectTree {
  std::uint32_t mesh = 0;
  std::uint32_t only = kNone;  ///< the only instance that uses the tree, if the mesh cannot be shared, otherwise kNone
  bool in_world = false;       ///< the triangles are in world space, because the instance's matrix has no inverse
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_node = 0;  ///< root node of the tree, whose nodes end where the next tree begins
};

/// The scene as stored in the GPU's memory, in one of two forms: all instances flattened into world space under one
/// tree, or two levels (two_level.h), a tree over instances followed by one tree per mesh in its own space.
struct MemoryImage {
  std::vector<NodeRecord> nodes;     ///< nodes of all trees; node 0 is the root; empty if the trees are wide
  std::vector<WideNode> wide_nodes;  ///< nodes of all trees if they are wide (BvhConfig::is_wide), otherwise empty
  NodeFormat wide_format = NodeFormat::kFp32;  ///< format of wide nodes
  std::uint32_t width = 2;                     ///< most children of a node
  ChildOrder child_order = ChildOrder::kSort;  ///< order of visits in wide trees
  LeafFormat leaf_format = LeafFormat::kTriangles;
  /// With leaf records of several triangles (leaf_format.h): for each triangle, whether a record begins with it.
  /// Otherwise empty.
  std::vector<bool> begins_record;
  std::vector<InstanceRecord> instances;  ///< instances of a two-level image, in the order of Scene::instances
  std::vector<ObjectTree> trees;       ///< in two levels, the trees of meshes, shared ones first; used only by the host
  std::vector<std::uint32_t> tree_of;  ///< for each instance, the index of its tree; kNone if it has no triangles
  /// Sizes of each tree at its last build: the only tree or the tree over instances, then those of `trees`. Used only
  /// by the host.
  std::vector<BuildStatistics> build_statistics;
  std::vector<TriangleRecord> triangles;  ///< triangles in leaf order
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< vertex data; empty if no material needs them
  std::vector<MaterialRecord> materials;
  std::vector<MaterialDetailRecord> details;  ///< further material data; empty if no material needs them
  std::vector<Texture> textures;              ///< textures, with texels row by row; in the GPU's memory they are tiled
  /// With mip maps, the number of levels of each texture that is a first level, and 0 for textures that are later
  /// levels; otherwise empty. Each level is a texture of its own, stored after the previous level. Materials name the
  /// first level.
  std::vector<std::uint32_t> mip_levels;
  std::uint32_t white = kNoTexture;  ///< a texture with one white texel, for flagged triangles without a base texture
  std::vector<Light> lights;
  glm::vec3 background{0}, ambient{0};
  glm::vec3 lower{0}, upper{0};  ///< bounds of all triangles
  std::optional<BoxGrid> grid;   ///< with hybrid numbers, the grid on which the planes of all boxes are
  Layout layout;
  bool has_roughness = false;  ///< built with Roughness::kOn
  bool is_wide() const { return !wide_nodes.empty(); }
  /// Returns the number of nodes of all trees.
  std::size_t node_count() const { return is_wide() ? wide_nodes.size() : nodes.size(); }
  /// Returns how many slots of a wide node may have children; octant slots are spread over all.
  std::uint32_t wide_slots() const { return wide_format == NodeFormat::kCw80 ? kMaxWidth : width; }
  /// Returns the link words of a node's children.
  std::span<const std::uint32_t> links_of(std::uint32_t node) const {
    if (is_wide()) return wide_nodes[node].child;
    return nodes[node].child;
  }
  bool has_two_levels() const { return !instances.empty(); }
  bool has_mip_maps() const { return !mip_levels.empty(); }
  bool has_single_sided() const;  ///< True if rays pass through the back faces of some material.
  std::uint64_t node_array_bytes() const;
  float diagonal() const;
};

struct BvhConfig;

ImageCounts counts_of(const MemoryImage& image);

/// Computes the addresses of all arrays of an image. The arrays follow each other; each begins on a new memory line. Of
/// `image` only the links of nodes and the bounds of leaf records are read; `counts` has the number of all records.
Layout layout_of(const ImageCounts& counts, const MemoryImage& image, const BvhConfig& config);

/// Returns the bounds of the tree with the given root node, from the boxes of the root's children.
Bounds tree_bounds(const MemoryImage& image, std::uint32_t root);

/// Returns the parent of each inner node of the BVH; a root is its own parent. For a two-level BVH, the parents of all
/// instances follow.
std::vector<std::uint32_t> parent_indices(const MemoryImage& image);

}  // namespace traces
