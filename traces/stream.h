#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "traces/ray.h"

namespace traces {

/// Shader kernels are known to the stream by number; shader_kernels/catalogue.h gives them names and bodies.
using KernelId = std::uint16_t;

/// One access of a kernel to memory through the SRP's data cache, by what it names, not where it lies.
struct Access {
  enum class Kind : std::uint32_t { kAttributes, kMaterial, kTexels, kVertices, kDetail, kTriangle, kInstance };
  // kAttributes, kVertices, kTriangle: element = triangle. kMaterial, kDetail: element = material.
  // kInstance: element = instance.
  // kTexels: `object` = texture, a bilinear footprint of up to 2 x 2 texels packed by texels().
  std::uint32_t object = 0;  ///< kind in the top 3 bits, texture index below
  std::uint32_t element = 0;
  std::uint32_t element2 = 0;  ///< kTexels: the opposite corner of the footprint

  static Access record(Kind kind, std::uint32_t index) { return {static_cast<std::uint32_t>(kind) << 29, index, 0}; }
  static Access attributes(std::uint32_t triangle) { return record(Kind::kAttributes, triangle); }
  static Access material(std::uint32_t index) { return record(Kind::kMaterial, index); }
  static Access texels(std::uint32_t texture, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
    return {record(Kind::kTexels, 0).object | texture, (y0 << 16) | x0, (y1 << 16) | x1};
  }
  Kind kind() const { return static_cast<Kind>(object >> 29); }
  std::uint32_t texture() const { return object & ((1U << 29) - 1); }
};

/// How a node's items wait for an earlier node of the same tile.
struct Edge {
  enum class Kind : std::uint8_t {
    kAll,   ///< barrier: no item starts before every item of `node` is finished
    kEach,  ///< item i waits for item source(i) of `node` alone (i itself unless the node maps its items)
  };
  std::uint32_t node = 0;
  Kind kind = Kind::kAll;
};

/// Data that a transfer moves between a core's tile buffer and memory.
enum class Region : std::uint8_t {
  kPicture,  ///< finished pixels, a block per tile
  kSamples,  ///< attributes and colours of samples: halos, or all of them where the tile buffer does not hold them
  kRates,    ///< sampling rates of tiles, from frame to frame
  kCount
};

/// Bytes of a pixel of the picture: three channels in a packed format.
inline constexpr std::uint32_t kPixelBytes = 4;

/// Arrays in memory that a rasteriser reads and writes: vertices as the scene has them and as they come out of the
/// geometry pass, the numbers of each triangle's vertices, and the lists of triangles by part of the picture.
struct RasterDemands {
  std::uint32_t vertices = 0, triangles = 0;
  std::uint32_t entries = 0;  ///< those of all lists
  friend bool operator==(const RasterDemands&, const RasterDemands&) = default;
};

/// Storage that a machine must set aside for a frame.
struct FrameRequirements {
  std::uint32_t tile_samples = 0;          ///< those of a full tile
  std::uint32_t wave_samples = 0;          ///< samples of a tile traced at once, at most; 0: all
  std::uint32_t attribute_bytes = 0;       ///< what samples of a full tile keep beside their colour, in the tile buffer
  std::uint32_t pass_attribute_bytes = 0;  ///< those of a full tile of a later pass; 0: as in the first
  std::array<std::uint64_t, static_cast<std::size_t>(Region::kCount)> region_bytes{};
  std::optional<RasterDemands> raster{};  ///< the frame needs a rasteriser
  friend bool operator==(const FrameRequirements&, const FrameRequirements&) = default;
};

/// Samples that a tile leaves in memory for others: its borders have numbers of their own.
struct Border {
  std::uint32_t tile = 0;
  std::uint32_t number = 0;
  friend bool operator==(const Border&, const Border&) = default;
};
inline constexpr std::uint32_t kMostBorders = 8;   ///< that a tile may have
inline constexpr std::uint32_t kMostImports = 32;  ///< borders that a tile may read

/// A triangle on its way through a rasteriser.
struct RasterTriangle {
  std::uint32_t number = 0;                 ///< among the frame's
  std::array<std::uint32_t, 3> vertices{};  ///< among the frame's
  std::uint32_t lists = 0;                  ///< kBin: those that it goes into; none: it is culled
  // kRaster: what it covers. "Hidden" is what lies in blocks that it finds filled with nearer surfaces.
  std::uint32_t blocks = 0, hidden_blocks = 0;    ///< blocks of pixels that it may touch
  std::uint32_t quads = 0, hidden_quads = 0;      ///< 2 x 2 pixels of which it covers a sample
  std::uint32_t samples = 0, hidden_samples = 0;  ///< samples that it covers
  std::uint32_t passed = 0;                       ///< samples that it was the nearest at so far
  friend bool operator==(const RasterTriangle&, const RasterTriangle&) = default;
};

/// Entries of one list of triangles that lie behind each other.
struct ListRun {
  std::uint32_t first = 0, entries = 0;
  friend bool operator==(const ListRun&, const ListRun&) = default;
};

/// Data of a rasteriser's node beside its items: its parts of TileWork::raster_triangles and list_runs. Of kBin,
/// runs are written; of kRaster they are read, and have an entry for each triangle.
struct RasterWork {
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t first_run = 0, runs = 0;
  std::uint32_t pixel_samples = 1;  ///< kRaster: samples of a pixel, at most
};

/// A kernel launch, a batch of rays, a transfer between the tile buffer and memory, or work of a rasteriser: triangles
/// put into lists by where in the picture they lie, or primary hits of a wave found by what triangles cover.
struct WorkNode {
  enum class Kind : std::uint8_t { kLaunch, kRays, kTransfer, kBin, kRaster };
  Kind kind = Kind::kLaunch;
  RayKind ray_kind = RayKind::kPrimary;  ///< kRays
  KernelId kernel = 0;                   ///< kLaunch
  std::uint32_t items = 0;               ///< work items, rays, bytes to transfer, triangles (kBin), samples (kRaster)
  std::uint32_t first = 0;    ///< kRays: first ray of the tile; kLaunch: first entry of access_begin, if it has any
  bool has_accesses = false;  ///< kLaunch: items read memory through the data cache
  std::uint32_t idle = 0;     ///< kLaunch: items beyond `items` that pass through the loop and do nothing
  Region region = Region::kPicture;  ///< kTransfer
  bool to_memory = true;             ///< kTransfer
  std::uint64_t offset = 0;          ///< kTransfer: first byte within its region
  /// kTransfer: to memory, number of the tile's border that it completes; from memory, index in TileWork::imports of
  /// the border that it reads; or kNone.
  std::uint32_t border = kNone;
  std::uint32_t sources = kNone;  ///< first entry in TileWork::sources for mapped `each` edges (one per item), or kNone
  std::uint32_t raster = kNone;   ///< kBin, kRaster: index in TileWork::raster
  std::vector<Edge> inputs;
  static constexpr std::uint32_t kNone = 0xffffffffU;
};

/// All work of one tile of one frame: a graph in topological order (edges point to lower indices).
struct TileWork {
  std::uint32_t frame = 0;
  std::uint32_t tile = 0;
  std::uint32_t samples = 0;
  std::vector<Border> imports;  ///< borders of earlier tiles; transfers that read one wait for it
  bool after_all = false;       ///< all earlier tiles of the list must be finished before this one begins
  std::vector<WorkNode> nodes;
  std::vector<std::uint32_t> walk;          ///< canonical walks of all rays, back to back (walk.h)
  std::vector<std::uint32_t> ray_begin;     ///< per ray, where its walk begins
  std::vector<Access> accesses;             ///< those of all items of all launches that have any, in item order
  std::vector<std::uint32_t> access_begin;  ///< per such item, plus one past the end of the last
  std::vector<std::uint32_t> sources;       ///< see WorkNode::sources; non-decreasing within a node
  std::vector<RasterWork> raster;           ///< in the order of the nodes that have it, as the following two
  std::vector<RasterTriangle> raster_triangles;
  std::vector<ListRun> list_runs;
};

}  // namespace traces
