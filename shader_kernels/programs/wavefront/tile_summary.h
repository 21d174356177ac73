#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Items of a kernel, those that idle included.
struct KernelItems {
  traces::KernelId kernel = 0;
  std::uint32_t items = 0;
};

/// An entry of the tile list in a few numbers, without any machine.
struct TileSummary {
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< in pixels: the place that its frame program gives it
  bool begins_pass = false;                           ///< it waits for all entries before it
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t steps = 0, tests = 0;  ///< canonical ones: node visits and triangle tests; the latter alone
  std::uint64_t accesses = 0;          ///< accesses of kernels to records and texels
  std::uint64_t transfer_bytes = 0;    ///< between tile buffer and memory
  std::uint64_t kernels = 0;           ///< in TileSummaries::kernels: behind its last
};

/// Those of a frame, in the order of the list.
struct TileSummaries {
  std::vector<TileSummary> tiles;
  std::vector<KernelItems> kernels;  ///< one tile's after the other's
  void add(const TileResult& tile);
};

}  // namespace kernels
