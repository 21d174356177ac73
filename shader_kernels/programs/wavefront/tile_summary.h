#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Items of a kernel, including idle ones.
struct KernelItems {
  traces::KernelId kernel = 0;
  std::uint32_t items = 0;
};

/// Counts of an entry of the tile list, independent of any machine.
struct TileSummary {
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< in pixels, as set by the frame program
  bool begins_pass = false;                           ///< the entry waits for all earlier ones
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t steps = 0, tests = 0;  ///< canonical steps (node visits and triangle tests), and triangle tests alone
  std::uint64_t accesses = 0;          ///< accesses of kernels to records and texels
  std::uint64_t transfer_bytes = 0;    ///< between tile buffer and memory
  std::uint64_t kernels = 0;           ///< end of its part of TileSummaries::kernels
};

/// The summaries of a frame, in list order.
struct TileSummaries {
  std::vector<TileSummary> tiles;
  std::vector<KernelItems> kernels;  ///< of all tiles, one after the other
  void add(const TileResult& tile);
};

}  // namespace kernels
