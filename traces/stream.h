#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "traces/ray.h"

namespace traces {

/// Number of a shader kernel; shader_kernels/catalogue.h has the kernels' names and bodies.
using KernelId = std::uint16_t;

/// One read from memory by a kernel, through the SRP's data cache. An Access names an object and an element instead of
/// an address.
struct Access {
  enum class Kind : std::uint32_t {
    kAttributes,
    kMaterial,
    kTexels,
    kVertices,
    kDetail,
    kTriangle,
    kInstance,
    kStored
  };
  // What `element` is depends on the kind: a triangle (kAttributes, kVertices, kTriangle), a material (kMaterial,
  // kDetail), an instance (kInstance) or a 4-byte word of memory from region kSamples on (kStored). kTexels reads a
  // bilinear footprint of up to 2 x 2 texels, packed by texels().
  std::uint32_t object = 0;  ///< kind of access in the top 3 bits, texture index in the others
  std::uint32_t element = 0;
  std::uint32_t element2 = 0;  ///< for kTexels, the opposite corner of the footprint

  static Access of_kind(Kind kind, std::uint32_t index) { return {static_cast<std::uint32_t>(kind) << 29, index, 0}; }
  static Access attributes(std::uint32_t triangle) { return of_kind(Kind::kAttributes, triangle); }
  static Access material(std::uint32_t index) { return of_kind(Kind::kMaterial, index); }
  static Access texels(std::uint32_t texture, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    return {of_kind(Kind::kTexels, 0).object | texture, (y0 << 16) | x0, (y1 << 16) | x1};
  }
  Kind kind() const { return static_cast<Kind>(object >> 29); }
  std::uint32_t texture() const { return object & ((1U << 29) - 1); }
};

/// An edge of a tile's work graph: the items of a node wait for those of an earlier node of the same tile.
struct Edge {
  enum class Kind : std::uint8_t {
    kAll,   ///< a barrier: all items of `node` must finish before any item starts
    kEach,  ///< item i waits only for its source item of `node` (WorkNode::sources; item i if there are none)
  };
  std::uint32_t node = 0;
  Kind kind = Kind::kAll;
};

/// The part of memory that a transfer of a tile reads or writes.
enum class Region : std::uint8_t {
  kPicture,  ///< finished pixels, one block per tile
  kSamples,  ///< attributes and colours of samples that other tiles read, or that do not fit the tile buffer
  kRates,    ///< sampling rates of tiles, kept from frame to frame
  kBuild,    ///< arrays of kernels that build a tree
  kTree,     ///< the scene's tree, from its first node on
  kCount
};

/// Size in bytes of the words that accesses of kind kStored name.
inline constexpr std::uint32_t kStoredWordBytes = 4;

/// Size in bytes of a pixel of the picture: three channels in a packed format.
inline constexpr std::uint32_t kPixelBytes = 4;

/// Sizes of the rasteriser's arrays in memory: scene vertices, transformed vertices, vertex numbers of each triangle,
/// and the triangle lists of all screen regions.
struct RasterArraySizes {
  std::uint32_t vertices = 0, triangles = 0;
  std::uint32_t entries = 0;  ///< number of entries of all triangle lists together
  friend bool operator==(const RasterArraySizes&, const RasterArraySizes&) = default;
};

/// Sizes of the builder's arrays in memory: vertices and triangles of the trees that it builds, all of them together,
/// and instances.
struct BuildArraySizes {
  std::uint32_t vertices = 0, triangles = 0, instances = 0;
  std::uint64_t shadow_bytes = 0;  ///< size of a second copy of the tree, which is written while rays read the first
  friend bool operator==(const BuildArraySizes&, const BuildArraySizes&) = default;
};

/// Memory that a machine must set aside for a frame.
struct FrameRequirements {
  std::uint32_t tile_samples = 0;     ///< number of samples of a full tile
  std::uint32_t wave_samples = 0;     ///< largest number of samples that a tile traces together; 0: all its samples
  std::uint32_t attribute_bytes = 0;  ///< bytes in the tile buffer of a full tile's samples, without colours
  std::uint32_t pass_attribute_bytes = 0;  ///< `attribute_bytes` of later passes; 0: as in the first pass
  std::array<std::uint64_t, static_cast<std::size_t>(Region::kCount)> region_bytes{};
  std::optional<RasterArraySizes> raster{};  ///< present if the frame needs a rasteriser
  std::optional<BuildArraySizes> build{};    ///< present if a tree builder works for the frame
  friend bool operator==(const FrameRequirements&, const FrameRequirements&) = default;
};

/// A set of samples that a tile writes to memory for other tiles. Each tile numbers its own borders.
struct Border {
  std::uint32_t tile = 0;
  std::uint32_t number = 0;
  friend bool operator==(const Border&, const Border&) = default;
};
inline constexpr std::uint32_t kMostBorders = 8;   ///< largest number of borders that one tile exports
inline constexpr std::uint32_t kMostImports = 32;  ///< largest number of borders that one tile imports

/// A triangle and the work that it causes in the rasteriser.
struct RasterTriangle {
  std::uint32_t number = 0;                 ///< index of the triangle in the frame
  std::array<std::uint32_t, 3> vertices{};  ///< indices of the triangle's vertices in the frame
  std::uint32_t lists = 0;  ///< for kBin, the number of lists that the triangle is added to; 0 if it is culled
  // Counts for kRaster. "Hidden" means in a block of pixels that nearer surfaces already fill.
  std::uint32_t blocks = 0, hidden_blocks = 0;    ///< blocks of pixels that the triangle may touch
  std::uint32_t quads = 0, hidden_quads = 0;      ///< 2 x 2 pixel quads with a covered sample
  std::uint32_t samples = 0, hidden_samples = 0;  ///< samples that the triangle covers
  std::uint32_t passed = 0;                       ///< covered samples that passed the depth test
  friend bool operator==(const RasterTriangle&, const RasterTriangle&) = default;
};

/// A range of consecutive entries in one triangle list.
struct ListRun {
  std::uint32_t first = 0, entries = 0;
  friend bool operator==(const ListRun&, const ListRun&) = default;
};

/// Data of a rasteriser node: ranges within TileWork::raster_triangles and TileWork::list_runs. A kBin node writes its
/// list runs; a kRaster node reads its list runs, which have one entry per triangle.
struct RasterWork {
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_run = 0, runs = 0;
  std::uint32_t pixel_samples = 1;  ///< for kRaster, the largest number of samples per pixel
};

/// Work of the tree builder: one tree over triangles or instances, to be built or refitted. Offsets are relative to the
/// first node of the scene (Layout::nodes).
struct BuildWork {
  enum class Input : std::uint8_t { kTriangles, kInstances };
  struct Range {
    std::uint64_t offset = 0, bytes = 0;
    friend bool operator==(const Range&, const Range&) = default;
  };
  Input input = Input::kTriangles;
  bool refit = false;
  std::uint32_t first = 0;        ///< the tree's first triangle in TileWork::build_triangles and build_order
  std::uint32_t first_item = 0;   ///< number of the tree's first triangle or instance among those of the frame
  std::array<Range, 3> output{};  ///< nodes, leaf records and labels of the finished tree
  std::uint64_t comparisons = 0;  ///< comparisons of clusters by PLOC (bvh.builder: ploc)
  friend bool operator==(const BuildWork&, const BuildWork&) = default;
};

/// A node of a tile's graph of work: a kernel launch, a batch of rays, a transfer between tile buffer and memory, the
/// binning of triangles into the lists of screen regions, the rasterisation of a wave's primary hits, or the building
/// of a tree. The node of a tree is the only one of its entry in the tile list.
struct WorkNode {
  enum class Kind : std::uint8_t { kLaunch, kRays, kTransfer, kBin, kRaster, kBuild };
  Kind kind = Kind::kLaunch;
  RayKind ray_kind = RayKind::kPrimary;  ///< for kRays: the kind of rays
  KernelId kernel = 0;                   ///< for kLaunch: the kernel that runs
  /// Number of work items, rays, bytes (kTransfer), triangles (kBin), samples (kRaster), triangles or instances
  /// (kBuild).
  std::uint32_t items = 0;
  std::uint32_t first = 0;    ///< kRays: its first ray in the tile; kLaunch with accesses: first index in access_begin;
                              ///< kBuild: index in TileWork::build
  bool has_accesses = false;  ///< for kLaunch: its items read memory through the data cache
  std::uint32_t idle = 0;     ///< for kLaunch: number of inactive iterations after the last item
  Region region = Region::kPicture;  ///< for kTransfer: the part of memory that it accesses
  bool to_memory = true;             ///< for kTransfer: true if it writes to memory
  std::uint64_t offset = 0;          ///< for kTransfer: first byte within its region
  /// For kTransfer to memory, the number of the tile's border that it completes. For kTransfer from memory, the index
  /// in TileWork::imports of the border that it reads. Otherwise kNone.
  std::uint32_t border = kNone;
  std::uint32_t sources = kNone;  ///< if kEach edges map items: its first index in TileWork::sources; otherwise kNone
  std::uint32_t raster = kNone;   ///< for kBin and kRaster: index in TileWork::raster
  std::vector<Edge> inputs;
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// The work of one tile of one frame: a graph in topological order (edges point to lower indices).
struct TileWork {
  /// True if the entry is work of the tree builder.
  bool is_build() const { return !nodes.empty() && nodes.front().kind == WorkNode::Kind::kBuild; }

  std::uint32_t frame = 0;
  std::uint32_t tile = 0;
  std::uint32_t samples = 0;
  std::vector<Border> imports;  ///< borders of earlier tiles; a transfer that reads one waits for it
  bool after_all = false;       ///< barrier: all earlier tiles of the list must finish first
  std::vector<WorkNode> nodes;
  std::vector<std::uint32_t> walk;          ///< canonical walks of all rays, concatenated (walk.h)
  std::vector<std::uint32_t> ray_begin;     ///< for each ray, the index in `walk` of its first word
  std::vector<std::uint32_t> ray_keys;      ///< sort key of each ray (ray_key.h); empty in work read from a trace
  std::vector<Access> accesses;             ///< memory accesses of all launches with has_accesses, in item order
  std::vector<std::uint32_t> access_begin;  ///< index of the first access of each item with accesses; then the end
  std::vector<std::uint32_t> sources;       ///< source items (WorkNode::sources); non-decreasing within a node
  std::vector<RasterWork> raster;           ///< data of rasteriser nodes, in node order, like the next two vectors
  std::vector<RasterTriangle> raster_triangles;
  std::vector<ListRun> list_runs;
  std::vector<BuildWork> build;  ///< data of kBuild nodes, in node order, like the next two vectors
  std::vector<std::array<std::uint32_t, 3>> build_triangles;  ///< vertex numbers of each triangle, in input order
  std::vector<std::uint32_t> build_order;                     ///< input numbers of a tree's triangles, in leaf order
};

}  // namespace traces
