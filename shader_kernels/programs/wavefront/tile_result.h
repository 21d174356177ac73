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

/// A sample as post-correction stores it: identity word and colour.
struct CorrectionSample {
  std::uint32_t identity = 0;
  glm::vec3 colour{};
};

/// Colour and state of a sub-pixel, as the program supersample stores them for later rounds of propagation.
struct PropagationSubpixel {
  std::uint32_t x = 0, y = 0;  ///< position in the picture's grid of sub-pixels
  SubpixelRecord<float> state{};
  glm::vec3 colour{};
  bool is_background = false;  ///< the primary ray at the pixel's centre hit nothing
};

/// All results that a frame program returns for one entry (mostly a tile) of its list.
struct TileResult {
  /// If not null, rasterisation by this rasteriser is recorded instead of primary rays (geometry_pass.h).
  const traces::Rasteriser* rasteriser = nullptr;
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< rectangle of the tile in the picture, in pixels
  std::vector<glm::vec3> linear;                      ///< for each pixel, row by row: linear RGB in [0, 1]
  std::vector<std::uint32_t> packed;  ///< for each pixel, the word of the frame buffer, R in the lowest byte
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t continued = 0;  ///< rays that continued after a transparent surface; `rays` includes them
  Sampling sampling;
  std::vector<SampleMark> marks;               ///< debug marks, per sample or pixel of the tile, row by row
  std::vector<CorrectionSample> shown;         ///< the tile's samples, row by row, if a later pass needs them
  std::vector<PropagationSubpixel> subpixels;  ///< all the tile's sub-pixels, or those that a round made active
  std::vector<std::uint32_t> corrected;        ///< pixels of the picture whose new colours are in `linear`
  std::vector<std::uint32_t> background;       ///< samples whose primary ray hit nothing, in the order traced
  std::uint64_t traversal_steps = 0;           ///< node visits and triangle tests of the rays' walks; 0 if not recorded
  std::uint64_t triangle_tests = 0;            ///< triangle tests among `traversal_steps`
  bool wants_pixel_work = false;               ///< set before rendering to fill `pixel_work`
  std::vector<PixelWork> pixel_work;  ///< work per pixel; a pixel may have several entries, or be a neighbour's
  traces::TileWork work;              ///< the graph of work, if it is recorded
  TileBuffer buffer;
  /// Returns a sample's colour, clamped to [0, 1]. A pixel is the mean of sample colours that are clamped in this way.
  glm::vec3 averaged_colour(std::uint32_t sample) const;
};

/// Number of loop iterations that a kernel has run, including iterations without work.
struct KernelItems {
  traces::KernelId kernel = 0;
  std::uint32_t items = 0;
};

/// Work of one entry of the tile list, in counts that do not depend on a machine.
struct TileSummary {
  std::uint32_t tile = 0;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  ///< rectangle of the tile in the picture, in pixels
  bool begins_pass = false;                           ///< the entry waits for all earlier ones
  std::array<std::uint64_t, static_cast<std::size_t>(traces::RayKind::kCount)> rays{};
  std::uint64_t steps = 0, tests = 0;  ///< canonical steps (node visits and triangle tests), and triangle tests alone
  std::uint64_t accesses = 0;          ///< number of records and texels that kernels read through the data cache
  std::uint64_t transfer_bytes = 0;    ///< bytes moved between tile buffer and memory
  std::uint64_t kernels = 0;           ///< index in TileSummaries::kernels after the last entry of this tile
};

/// The summaries of all entries of a frame (mostly tiles), in list order.
struct TileSummaries {
  std::vector<TileSummary> tiles;
  std::vector<KernelItems> kernels;  ///< item counts of all kernels, one tile after the other
  void add(const TileResult& tile);
};

}  // namespace kernels
