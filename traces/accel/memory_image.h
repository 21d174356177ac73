#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "traces/accel/box_grid.h"
#include "traces/accel/bvh_config.h"
#include "traces/ray.h"
#include "traces/scene/scene.h"

namespace traces {

/// Inner node of the 2-wide BVH, one 64-byte line: both child boxes and two links. Bounds are kept axis by axis as
/// {lower of child 0, lower of child 1, upper of child 0, upper of child 1}, so that four lanes test both boxes. In
/// hybrid numbers a bound is a plane of the image's grid, a whole number; how many bits and bytes that takes in the
/// GPU's memory, and whether boxes lie there in pairs, is said in node_format.h.
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

// A leaf of the tree over instances names one of them. In memory its level says that; here a bit of the link does that
// no first triangle has.
inline constexpr std::uint32_t kInstanceBit = 1U << 27;
static_assert(kMaxTriangles <= kInstanceBit && kMaxInstances <= kMaxTriangles);
constexpr std::uint32_t instance_link(std::uint32_t instance) { return leaf_link(kInstanceBit | instance, 1); }
constexpr bool is_instance(std::uint32_t link) { return is_leaf(link) && (link & kInstanceBit) != 0; }
constexpr std::uint32_t link_instance(std::uint32_t link) { return leaf_first(link) & (kInstanceBit - 1); }

/// In an object id: of an instance in focus.
inline constexpr std::uint32_t kFocusObject = 1U << 30;

/// A mesh somewhere in the world, one line: read by traversal units on the way into its tree, and by kernels for what
/// hits there need. Rows of the matrix that carries points to the mesh's space; its upper left part transposed carries
/// normals the other way.
struct alignas(64) InstanceRecord {
  float to_object[3][4];
  std::uint32_t root;    ///< a node: root of the mesh's tree
  std::uint32_t object;  ///< as in TriangleRecord
  float handedness;      ///< -1 if it is mirrored, else 1
  float volume;          ///< what it scales volumes by: the absolute determinant of the matrix to the world
};
static_assert(sizeof(InstanceRecord) == 64);

// Culled faces in TriangleRecord::material: a ray that sees the corners in that order passes through the triangle. The
// first phase of the intersection test decides it by the sign of the plane's slope along the ray.
inline constexpr std::uint32_t kNoClockwise = 1U << 29, kNoCounterClockwise = 1U << 28;

/// Triangle for the intersection unit: 48 bytes, three vertices and what a hit must say without another fetch.
struct TriangleRecord {
  glm::vec3 v0, v1, v2;
  std::uint32_t object;    ///< object id: index of the instance, with kFocusObject above it; 0 if that is for
                           ///< InstanceRecord to say
  std::uint32_t material;  ///< index; above it the culled faces and the flags of ray.h
  std::uint32_t source;  ///< index of the triangle before leaf order (instance by instance; in two levels: in its mesh)
  std::uint32_t flags() const { return material & ~kTriangleMask; }
};
static_assert(sizeof(TriangleRecord) == 48);

/// Attributes for shading, through the SRP's data cache: 64 bytes per triangle, same index as the triangle record.
struct AttributeRecord {
  /// Shading normals in world space (in two levels: the mesh's): unit vectors, or with mip maps as long as the
  /// triangle's texture is dense: the root of its area in texture coordinates over that in space (kLeastDensity to
  /// kMostDensity).
  glm::vec3 normal[3];
  glm::vec2 uv[3];
  std::uint32_t material;
};
static_assert(sizeof(AttributeRecord) == 64);

inline constexpr float kLeastDensity = 0x1p-20F, kMostDensity = 0x1p20F;

/// Vertices that some materials need besides, 64 bytes per triangle, same index again; there only if the scene has such
/// a material (kVertexed).
struct VertexRecord {
  glm::vec2 uv[3];             ///< Mesh::second_uvs
  std::uint32_t colour[3][2];  ///< RGBA, 16 bits a channel, linear, R lowest
  std::uint32_t tangent[3];    ///< world space x, y, z and the bitangent's sign: bytes 128 + 127 * value, x lowest
  std::uint32_t spare;         ///< keeps the record one line
};
static_assert(sizeof(VertexRecord) == 64);

/// MaterialRecord::flags. The first two groups are streams that the frame program's inspectors make of surfaces.
enum MaterialFlag : std::uint32_t {
  kTextured = 1,        ///< the base texture is a factor of the diffuse colour and nothing else
  kDiffuse = 1U << 1,   ///< metal_rough textures decide for themselves
  kMirror = 1U << 2,    ///< likewise
  kGlass = 1U << 3,     ///< light enters
  kEmissive = 1U << 4,  ///< without a texture
  kVertexed = 1U << 5,  ///< vertex colours, second texture coordinates or tangents
  kBased = 1U << 6,     ///< a base texture that kTextured does not cover
  kPhysical = 1U << 7,  ///< metal_rough texture
  kBumped = 1U << 8,    ///< normal texture
  kAbsorbing = 1U << 9,
  kBlended = 1U << 10,      ///< Material::Alpha::kBlend
  kGlowing = 1U << 11,      ///< emission texture
  kOccluded = 1U << 12,     ///< occlusion texture
  kMasked = 1U << 13,       ///< Material::Alpha::kMask
  kSingleSided = 1U << 14,  ///< rays pass through back faces
  // Textures that are looked up with the second coordinates.
  kBaseSecond = 1U << 16,
  kMetalRoughSecond = 1U << 17,
  kNormalSecond = 1U << 18,
  kOcclusionSecond = 1U << 19,
  kEmissionSecond = 1U << 20,
};
inline constexpr std::uint32_t kDetailStreams = 0x1fe0U;  ///< those that cost nothing where no material has them

/// Material as every hit needs it: 64 bytes, all colours linear. With a metal_rough texture, mirrored is
/// 0 and the other shares are as if nothing were.
struct MaterialRecord {
  glm::vec3 base_colour;
  float diffuse_share;  ///< (1 - mirror) (1 - transmission)
  glm::vec3 mirrored;   ///< mirror * mirror_tint
  float entering;       ///< (1 - mirror) transmission, to be split by Fresnel's law
  glm::vec3 emission;
  float ior;
  std::uint32_t base_texture;  ///< kNoTexture or an index into textures
  std::uint32_t flags;         ///< MaterialFlag
  float opacity;               ///< 1 if alpha does not count
  float alpha_cutoff;          ///< kMasked; otherwise 0
};
static_assert(sizeof(MaterialRecord) == 64);

/// The rest, 64 bytes per material; there only if some material needs it.
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

/// Where everything lies in the GPU's memory: byte addresses of arrays, 64-byte aligned. Textures are stored as RGBA8
/// in tiles of 4 x 4 texels, one line each, tiles row by row.
struct Layout {
  std::uint64_t nodes = 0, instances = 0, triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::uint32_t node_bytes = sizeof(NodeRecord);
  /// Records of each inner node's children, where records hold single boxes; otherwise empty, and a node's
  /// record has its index.
  std::vector<std::array<std::uint32_t, 2>> single_boxes;
  std::uint32_t triangle_bytes = sizeof(TriangleRecord);
  /// Where triangles are their vertices alone, the three words that follow them in TriangleRecord lie here.
  std::uint64_t labels = 0;
  struct TextureAt {
    std::uint64_t base = 0;
    std::uint32_t tiles_per_row = 0;
  };
  std::vector<TextureAt> textures;
  std::uint64_t frame_buffer = 0;
  std::uint64_t end = 0;  ///< first byte behind the scene, where the frame buffer begins

  static constexpr std::uint32_t kVerticesBytes = 36;
  static constexpr std::uint32_t kLabelBytes = sizeof(TriangleRecord) - kVerticesBytes;

  /// Record `i` of the tree.
  std::uint64_t node_at(std::uint32_t i) const { return nodes + std::uint64_t{i} * node_bytes; }
  std::uint64_t instance_at(std::uint32_t i) const { return instances + std::uint64_t{i} * sizeof(InstanceRecord); }
  std::uint64_t triangle_at(std::uint32_t i) const { return triangles + std::uint64_t{i} * triangle_bytes; }
  bool has_labels() const { return triangle_bytes == kVerticesBytes; }
  std::uint64_t label_at(std::uint32_t i) const { return labels + std::uint64_t{i} * kLabelBytes; }
  std::uint64_t attributes_at(std::uint32_t i) const { return attributes + std::uint64_t{i} * sizeof(AttributeRecord); }
  std::uint64_t material_at(std::uint32_t i) const { return materials + std::uint64_t{i} * sizeof(MaterialRecord); }
  std::uint64_t vertices_at(std::uint32_t i) const { return vertices + std::uint64_t{i} * sizeof(VertexRecord); }
  std::uint64_t detail_at(std::uint32_t i) const { return details + std::uint64_t{i} * sizeof(MaterialDetailRecord); }
  /// Address of the 4 x 4 tile that holds texel (x, y).
  std::uint64_t texel_tile_at(std::uint32_t texture, std::uint32_t x, std::uint32_t y) const {
    const TextureAt& t = textures[texture];
    return t.base + (std::uint64_t{y / 4} * t.tiles_per_row + x / 4) * 64;
  }
};

/// Whether textures lie in memory with mip levels.
enum class MipMaps : std::uint8_t { kOff, kOn };
constexpr std::array<std::string_view, 2> names_of(MipMaps) { return {"off", "on"}; }
/// Levels of all textures: their numbers are 16 bits where a footprint stands beside them.
inline constexpr std::uint32_t kMostMipLevels = 1U << 16;

/// How many records of each kind there are, the tree's aside, and how large textures are: with the tree, all that
/// the layout depends on.
struct ImageCounts {
  std::uint64_t triangles = 0, attributes = 0, vertices = 0, materials = 0, details = 0;
  std::vector<std::array<std::uint32_t, 2>> textures;  ///< width and height
  std::uint64_t instances = 0, trees = 0;              ///< two levels: trees below the one over instances
  friend bool operator==(const ImageCounts&, const ImageCounts&) = default;
};

/// Where what belongs to a tree over triangles lies in the arrays.
struct ObjectTree {
  std::uint32_t mesh = 0;
  std::uint32_t only = kNone;  ///< the one instance that it is for, if it cannot be shared
  bool in_world = false;       ///< its triangles stand in world space, as the instance's matrix has no inverse
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_node = 0;  ///< the root; the last tree ends with the array
};

/// The scene as the GPU's memory holds it. Either its instances are flattened into world space, under one tree, or
/// there are two levels (two_level.h): a tree over instances first, then one for each mesh in its own space.
struct MemoryImage {
  std::vector<NodeRecord> nodes;          ///< node 0 is the root
  std::vector<InstanceRecord> instances;  ///< two levels: as in Scene::instances; otherwise empty
  std::vector<ObjectTree> trees;          ///< two levels, for the host; those that are shared first
  std::vector<std::uint32_t> tree_of;     ///< tree of each instance; kNone where there is nothing to see
  std::vector<TriangleRecord> triangles;  ///< in leaf order
  std::vector<AttributeRecord> attributes;
  std::vector<VertexRecord> vertices;  ///< or empty
  std::vector<MaterialRecord> materials;
  std::vector<MaterialDetailRecord> details;  ///< or empty
  std::vector<Texture> textures;              ///< texels decoded row by row; only their addresses are tiled
  /// Mip maps, otherwise empty: each level is a texture of its own, behind the one it is half of, and materials name
  /// the first. Of a first level, how many there are; of others 0.
  std::vector<std::uint32_t> mip_levels;
  std::uint32_t white = kNoTexture;  ///< a white texel, for flagged triangles without a base texture
  std::vector<Light> lights;
  glm::vec3 background{0}, ambient{0};
  glm::vec3 lower{0}, upper{0};  ///< bounds of all triangles
  std::optional<BoxGrid> grid;   ///< that the nodes' boxes lie on, in hybrid numbers
  Layout layout;
  bool has_levels() const { return !instances.empty(); }
  bool has_mip_maps() const { return !mip_levels.empty(); }
  bool has_single_sided() const;  ///< rays pass through the back faces of some material
  std::uint64_t node_array_bytes() const;
  float diagonal() const;
};

struct BvhConfig;

ImageCounts counts_of(const MemoryImage& image);

/// Where everything lies: one array behind the other, each on a line of its own.
Layout layout_of(const ImageCounts& counts, const std::vector<NodeRecord>& nodes, const BvhConfig& config);

/// The inner node above each inner node; a tree's root is its own. Behind them, of two levels, the node above each
/// instance.
std::vector<std::uint32_t> parents_of(const MemoryImage& image);

}  // namespace traces
