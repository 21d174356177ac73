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

/// A sample as post-correction sees it.
struct ShownSample {
  std::uint32_t identity = 0;
  glm::vec3 colour{};
};

/// A sub-pixel as later rounds of propagation see it.
struct ShownSubpixel {
  std::uint32_t x = 0, y = 0;  ///< in the picture's grid of sub-pixels
  SubpixelRecord<float> state{};
  glm::vec3 colour{};
  bool is_background = false;  ///< by the sample at its pixel's centre
};

/// Result of one tile.
struct TileResult {
  /// Makes the work of primary waves in place of rays, if it is not null (geometry_pass.h).
  const traces::Rasteriser* rasteriser = nullptr;
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< in pixels
  std::vector<glm::vec3> linear;                      ///< per pixel, row by row: linear RGB in [0, 1]
  std::vector<std::uint32_t> packed;                  ///< per pixel: as the frame buffer holds it, R in the lowest byte
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t continued = 0;  ///< rays that went on behind what was no solid surface, counted above, too
  Sampling sampling;
  std::vector<SampleMark> marks;          ///< adaptive sampling's, per sample (or pixel) of the tile, row by row
  std::vector<ShownSample> shown;         ///< its own samples, row by row, if a later pass looks at them
  std::vector<ShownSubpixel> subpixels;   ///< its own, or those that a round has made active
  std::vector<std::uint32_t> corrected;   ///< pixels of the picture whose new colours a round has put into `linear`
  std::vector<std::uint32_t> background;  ///< samples whose primary ray hit nothing, in the order traced
  std::uint64_t traversal_steps = 0;  ///< node visits and triangle tests; counted from the walks, so 0 if not recorded
  std::uint64_t triangle_tests = 0;   ///< those of these steps that are triangle tests
  bool wants_pixel_work = false;      ///< says, before the tile is made, whether `pixel_work` is to be filled
  std::vector<PixelWork> pixel_work;  ///< a pixel may be there several times, also one of a neighbour's
  traces::TileWork work;              ///< filled if recorded
  TileBuffer buffer;
  /// Colour of a sample as it is averaged.
  glm::vec3 colour(std::uint32_t sample) const;
};

}  // namespace kernels
