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
#include "traces/walk_steps.h"

namespace traces {

inline constexpr std::size_t kRegionCount = static_cast<std::size_t>(Region::kCount);
inline constexpr std::size_t kRayKinds = static_cast<std::size_t>(RayKind::kCount);

/// The most bytes of a tile, and nodes: real ones have up to some hundreds, and at the largest render.layers and
/// render.depth some hundred thousand. A node in memory takes many times its bytes.
inline constexpr std::uint64_t kMaxTileBytes = 1U << 26;
inline constexpr std::uint32_t kMaxTileNodes = 1U << 20;

/// Bounds of what the work of a tile may refer to.
struct TileScope {
  Links links;
  ImageCounts counts;
  std::uint32_t kernels = 0;
  std::array<std::uint64_t, kRegionCount> region_bytes{};
  std::optional<RasterDemands> raster{};     ///< if there is a rasteriser
  std::uint64_t tile_bytes = kMaxTileBytes;  ///< that it may take
};

/// Numbers of a tile's rays, beside its work.
struct TileRays {
  std::array<std::uint64_t, kRayKinds> by_kind{};
  WalkSteps steps;
};

/// Appends a tile's work as bytes (docs/trace-format.md says which). Walks that are none on this tree are written as
/// they are, which costs more. InputError for work that the format cannot say.
class TileEncoder {
 public:
  void encode(const TileWork& work, const Links& links, std::string& out);

 private:
  AccessWriter accesses_;
};

/// Reads tiles back, and uses the storage of former ones again.
class TileDecoder {
 public:
  /// `bytes` is followed by kBitsPadding bytes more. InputError, without the file's name, if the bytes are no tile
  /// within this scope: what is returned can be played by any machine.
  TileRays decode(std::string_view bytes, const TileScope& scope, TileWork& work);

 private:
  void read_launch(ByteReader& from, const TileScope& scope, WorkNode& node);
  void read_rays(ByteReader& from, WorkNode& node);
  void read_kind(ByteReader& from, const TileScope& scope, WorkNode& node);
  void read_nodes(ByteReader& from, const TileScope& scope, TileWork& work);
  WorkNode& next_node(TileWork& work);

  AccessReader accesses_;
  std::vector<WorkNode> spare_;
  std::uint32_t nodes_ = 0, rays_ = 0, items_ = 0;
  std::uint64_t most_items_ = 0;
  TileRays found_;
};

}  // namespace traces
