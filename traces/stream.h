#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
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

/// Storage that a machine must set aside for a frame.
struct FrameRequirements {
  std::uint32_t tile_samples = 0;          ///< those of a full tile
  std::uint32_t wave_samples = 0;          ///< samples of a tile traced at once, at most; 0: all
  std::uint32_t attribute_bytes = 0;       ///< what samples of a full tile keep beside their colour, in the tile buffer
  std::uint32_t pass_attribute_bytes = 0;  ///< those of a full tile of a later pass; 0: as in the first
  std::array<std::uint64_t, static_cast<std::size_t>(Region::kCount)> region_bytes{};
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

/// A kernel launch, a batch of rays, or a transfer between the tile buffer and memory.
struct WorkNode {
  enum class Kind : std::uint8_t { kLaunch, kRays, kTransfer };
  Kind kind = Kind::kLaunch;
  RayKind ray_kind = RayKind::kPrimary;  ///< kRays
  KernelId kernel = 0;                   ///< kLaunch
  std::uint32_t items = 0;               ///< work items, rays, or bytes to transfer
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
};

}  // namespace traces
