#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/wavefront/sampling.h"
#include "shader_kernels/programs/wavefront/tile_buffer.h"
#include "shader_kernels/records.h"
#include "traces/raster/rasteriser.h"
#include "traces/ray.h"
#include "traces/stream.h"

namespace kernels {

using traces::kPixelBytes;

/// A sample for post-correction.
struct ShownSample {
  std::uint32_t identity = 0;
  glm::vec3 colour{};
};

/// A sub-pixel for later rounds of propagation.
struct ShownSubpixel {
  std::uint32_t x = 0, y = 0;  ///< position in the picture's grid of sub-pixels
  SubpixelRecord<float> state{};
  glm::vec3 colour{};
  bool is_background = false;  ///< the sample at its pixel's centre hit nothing
};

/// Result of one tile.
struct TileResult {
  /// If not null, makes the work of primary waves instead of rays (geometry_pass.h).
  const traces::Rasteriser* rasteriser = nullptr;
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< in pixels
  std::vector<glm::vec3> linear;                      ///< per pixel, row by row: linear RGB in [0, 1]
  std::vector<std::uint32_t> packed;                  ///< per pixel: as in the frame buffer, R in the lowest byte
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t continued = 0;  ///< rays that continued after a surface that was not solid; also counted above
  Sampling sampling;
  std::vector<SampleMark> marks;          ///< of adaptive sampling: per sample or pixel of the tile, row by row
  std::vector<ShownSample> shown;         ///< the tile's samples, row by row, if a later pass needs them
  std::vector<ShownSubpixel> subpixels;   ///< all sub-pixels of the tile, or those that a round made active
  std::vector<std::uint32_t> corrected;   ///< pixels of the picture whose new colours a round stored in `linear`
  std::vector<std::uint32_t> background;  ///< samples whose primary ray hit nothing, in the order traced
  std::uint64_t traversal_steps = 0;      ///< node visits and triangle tests, counted from the walks; 0 if not recorded
  std::uint64_t triangle_tests = 0;       ///< triangle tests among these steps
  bool wants_pixel_work = false;          ///< set before rendering: fill `pixel_work`
  std::vector<PixelWork> pixel_work;      ///< a pixel may have several entries, and may belong to a neighbour
  traces::TileWork work;                  ///< filled if recorded
  TileBuffer buffer;
  /// Returns a sample's colour as used for averaging.
  glm::vec3 averaged_colour(std::uint32_t sample) const;
};

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
