#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "traces/accel/memory_image.h"
#include "traces/stream.h"
#include "traces/trace_file/access_code.h"
#include "traces/trace_file/tree_links.h"
#include "traces/walk.h"

namespace traces {

inline constexpr std::size_t kRegionCount = static_cast<std::size_t>(Region::kCount);
inline constexpr std::size_t kRayKinds = static_cast<std::size_t>(RayKind::kCount);

/// Largest encoded size of a tile, and largest number of nodes. Real tiles have up to some hundred nodes, or some
/// hundred thousand with the largest render.layers and render.depth. A node takes many times its encoded bytes in
/// memory.
inline constexpr std::uint64_t kMaxTileBytes = 1U << 26;
inline constexpr std::uint32_t kMaxTileNodes = 1U << 20;

/// Limits for the references and sizes in a tile's work, by which a decoded tile is checked.
struct TileScope {
  Links links;
  ImageCounts counts;
  std::uint32_t kernels = 0;
  std::array<std::uint64_t, kRegionCount> region_bytes{};
  std::optional<RasterArraySizes> raster{};  ///< present if the trace has a rasteriser
  std::optional<BuildArraySizes> build{};    ///< present if the trace has work for a tree builder
  std::uint64_t tile_bytes = kMaxTileBytes;  ///< largest encoded size of the tile
  bool look_ups = false;                     ///< walks may begin with look-ups of predicted nodes
};

/// Number of rays of a decoded tile, and the traversal steps of their recorded walks.
struct TileRays {
  std::array<std::uint64_t, kRayKinds> by_kind{};
  WalkSteps steps;
};

/// Encodes the work of a tile as bytes (docs/trace-format.md). Walks (recorded traversals of rays) that do not match
/// the BVH are stored as plain words, which take more space. Throws InputError for work that the format cannot
/// represent.
class TileEncoder {
 public:
  void encode_tile(const TileWork& work, const Links& links, std::string& out);

 private:
  AccessWriter accesses_;
};

/// Decodes the work of tiles. The decoder reuses its storage from tile to tile.
class TileDecoder {
 public:
  /// Decodes a tile and checks that any machine can execute it. `bytes` must be followed by kBitsPadding bytes. Throws
  /// InputError, without a file name, if the bytes are not a valid tile within `scope`.
  TileRays decode_tile(std::string_view bytes, const TileScope& scope, TileWork& work);

 private:
  void read_launch(ByteReader& from, const TileScope& scope, WorkNode& node);
  void read_rays(ByteReader& from, WorkNode& node);
  void read_kind(ByteReader& from, const TileScope& scope, WorkNode& node);
  void read_nodes(ByteReader& from, const TileScope& scope, TileWork& work);
  WorkNode& add_node(TileWork& work);

  AccessReader accesses_;
  std::vector<WorkNode> spare_;
  std::uint32_t nodes_ = 0, rays_ = 0, items_ = 0;
  std::uint64_t most_items_ = 0;
  TileRays found_;
};

}  // namespace traces
