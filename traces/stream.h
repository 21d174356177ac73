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

/// One kernel access to memory through the SRP's data cache. It names an object and element, not an address.
struct Access {
  enum class Kind : std::uint32_t { kAttributes, kMaterial, kTexels, kVertices, kDetail, kTriangle, kInstance };
  // `element` by kind: a triangle (kAttributes, kVertices, kTriangle), a material (kMaterial, kDetail) or an instance
  // (kInstance). kTexels reads a bilinear footprint of up to 2 x 2 texels, packed by texels().
  std::uint32_t object = 0;  ///< kind in the top 3 bits, texture index below
  std::uint32_t element = 0;
  std::uint32_t element2 = 0;  ///< kTexels: the opposite corner of the footprint

  static Access of_kind(Kind kind, std::uint32_t index) { return {static_cast<std::uint32_t>(kind) << 29, index, 0}; }
  static Access attributes(std::uint32_t triangle) { return of_kind(Kind::kAttributes, triangle); }
  static Access material(std::uint32_t index) { return of_kind(Kind::kMaterial, index); }
  static Access texels(std::uint32_t texture, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    return {of_kind(Kind::kTexels, 0).object | texture, (y0 << 16) | x0, (y1 << 16) | x1};
  }
  Kind kind() const { return static_cast<Kind>(object >> 29); }
  std::uint32_t texture() const { return object & ((1U << 29) - 1); }
};

/// A dependence of a node's items on an earlier node of the same tile.
struct Edge {
  enum class Kind : std::uint8_t {
    kAll,   ///< barrier: all items of `node` must finish before any item starts
    kEach,  ///< item i waits only for item source(i) of `node` (i itself if the node maps no items)
  };
  std::uint32_t node = 0;
  Kind kind = Kind::kAll;
};

/// Data that a transfer moves between a core's tile buffer and memory.
enum class Region : std::uint8_t {
  kPicture,  ///< finished pixels, a block per tile
  kSamples,  ///< attributes and colours of samples: halos, or all samples that do not fit the tile buffer
  kRates,    ///< sampling rates of tiles, kept from frame to frame
  kCount
};

/// Bytes of one picture pixel: three channels in a packed format.
inline constexpr std::uint32_t kPixelBytes = 4;

/// Sizes of the rasteriser's arrays in memory: scene vertices, transformed vertices, vertex numbers of each triangle,
/// and the triangle lists of all screen regions.
struct RasterDemands {
  std::uint32_t vertices = 0, triangles = 0;
  std::uint32_t entries = 0;  ///< entries of all lists together
  friend bool operator==(const RasterDemands&, const RasterDemands&) = default;
};

/// Storage that a machine must set aside for a frame.
struct FrameRequirements {
  std::uint32_t tile_samples = 0;          ///< samples of a full tile
  std::uint32_t wave_samples = 0;          ///< upper limit of samples traced together within a tile; 0: all samples
  std::uint32_t attribute_bytes = 0;       ///< tile-buffer bytes of a full tile's samples, without colours
  std::uint32_t pass_attribute_bytes = 0;  ///< the same in a later pass; 0: as in the first pass
  std::array<std::uint64_t, static_cast<std::size_t>(Region::kCount)> region_bytes{};
  std::optional<RasterDemands> raster{};  ///< present if the frame needs a rasteriser
  friend bool operator==(const FrameRequirements&, const FrameRequirements&) = default;
};

/// A set of samples that a tile writes to memory for other tiles. Each tile numbers its own borders.
struct Border {
  std::uint32_t tile = 0;
  std::uint32_t number = 0;
  friend bool operator==(const Border&, const Border&) = default;
};
inline constexpr std::uint32_t kMostBorders = 8;   ///< limit per exporting tile
inline constexpr std::uint32_t kMostImports = 32;  ///< limit per importing tile

/// A triangle and the work that it causes in the rasteriser.
struct RasterTriangle {
  std::uint32_t number = 0;                 ///< index within the frame
  std::array<std::uint32_t, 3> vertices{};  ///< indices within the frame
  std::uint32_t lists = 0;                  ///< kBin: number of lists that the triangle is added to; 0 if it is culled
  // kRaster: coverage counts. "Hidden" counts lie in blocks that nearer surfaces already fill.
  std::uint32_t blocks = 0, hidden_blocks = 0;    ///< pixel blocks that the triangle may touch
  std::uint32_t quads = 0, hidden_quads = 0;      ///< 2 x 2 pixel quads with a covered sample
  std::uint32_t samples = 0, hidden_samples = 0;  ///< covered samples
  std::uint32_t passed = 0;                       ///< samples that passed the depth test
  friend bool operator==(const RasterTriangle&, const RasterTriangle&) = default;
};

/// A run of consecutive entries in one triangle list.
struct ListRun {
  std::uint32_t first = 0, entries = 0;
  friend bool operator==(const ListRun&, const ListRun&) = default;
};

/// Rasteriser data of a work node: ranges within TileWork::raster_triangles and TileWork::list_runs. A kBin node writes
/// its runs. A kRaster node reads them; they have one entry per triangle.
struct RasterWork {
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_run = 0, runs = 0;
  std::uint32_t pixel_samples = 1;  ///< kRaster: largest number of samples per pixel
};

/// A unit of a tile's work. Its kind is a kernel launch, a batch of rays, a transfer between tile buffer and memory,
/// the binning of triangles into the lists of screen regions, or the rasterisation of a wave's primary hits.
struct WorkNode {
  enum class Kind : std::uint8_t { kLaunch, kRays, kTransfer, kBin, kRaster };
  Kind kind = Kind::kLaunch;
  RayKind ray_kind = RayKind::kPrimary;  ///< kRays
  KernelId kernel = 0;                   ///< kLaunch
  std::uint32_t items = 0;               ///< work items, rays, bytes (kTransfer), triangles (kBin) or samples (kRaster)
  std::uint32_t first = 0;    ///< kRays: the tile's first ray; kLaunch: first entry of access_begin, if has_accesses
  bool has_accesses = false;  ///< kLaunch: items read memory through the data cache
  std::uint32_t idle = 0;     ///< kLaunch: inactive iterations after the last item
  Region region = Region::kPicture;  ///< kTransfer
  bool to_memory = true;             ///< kTransfer
  std::uint64_t offset = 0;          ///< kTransfer: first byte within its region
  /// kTransfer to memory: number of the tile's border that it completes. kTransfer from memory: index in
  /// TileWork::imports of the border that it reads. Otherwise kNone.
  std::uint32_t border = kNone;
  std::uint32_t sources = kNone;  ///< first entry in TileWork::sources for mapped kEach edges (one entry per item), or
                                  ///< kNone
  std::uint32_t raster = kNone;   ///< kBin, kRaster: index in TileWork::raster
  std::vector<Edge> inputs;
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// The work of one tile of one frame: a graph in topological order (edges point to lower indices).
struct TileWork {
  std::uint32_t frame = 0;
  std::uint32_t tile = 0;
  std::uint32_t samples = 0;
  std::vector<Border> imports;  ///< borders of earlier tiles; a transfer that reads one waits for it
  bool after_all = false;       ///< barrier: all earlier tiles of the list must finish first
  std::vector<WorkNode> nodes;
  std::vector<std::uint32_t> walk;          ///< canonical walks of all rays, concatenated (walk.h)
  std::vector<std::uint32_t> ray_begin;     ///< start of each ray's walk
  std::vector<Access> accesses;             ///< accesses of all launches with has_accesses, in item order
  std::vector<std::uint32_t> access_begin;  ///< first access of each such item, plus one final end entry
  std::vector<std::uint32_t> sources;       ///< see WorkNode::sources; non-decreasing within a node
  std::vector<RasterWork> raster;           ///< like the next two vectors, in the order of the nodes that use it
  std::vector<RasterTriangle> raster_triangles;
  std::vector<ListRun> list_runs;
};

}  // namespace traces
