#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/wavefront/tile_result.h"
#include "traces/stream.h"

namespace kernels {

/// Numbers of the two borders that a tile exports: its last columns, and its last rows.
inline constexpr std::uint32_t kRightBorder = 0, kLowerBorder = 1;

/// Returns the bytes that a transfer of `records` scattered records moves: one memory line per record, but at most
/// `all` bytes.
std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all);

/// A tile of the picture, in samples.
struct SampleTile {
  std::uint32_t index = 0;     ///< number of the tile, in row order
  std::uint32_t x = 0, y = 0;  ///< position in the picture of the tile's first sample
  std::uint32_t width = 0, height = 0;
  std::uint32_t left = 0, above = 0, above_left = 0;  ///< indices of the neighbouring tiles, if they exist
  bool has_left = false, has_above = false;
  bool has_right = false, has_below = false;
};

/// Divides the samples of the picture into square tiles of whole pixels and whole blocks.
class SampleTiles {
 public:
  /// `side` is the desired side of a tile in samples, `samples_per_side` the number of samples along a pixel's side.
  /// Tile sides are multiples of `block`.
  SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t samples_per_side, std::uint32_t side,
              std::uint32_t block);

  std::uint32_t tile_count() const { return across_ * down_; }
  std::uint32_t tiles_across() const { return across_; }
  std::uint32_t tiles_down() const { return down_; }
  std::uint32_t tile_side() const { return side_; }
  std::uint32_t pixel_grid_side() const { return grid_; }
  SampleTile sample_tile(std::uint32_t index) const;
  /// Returns the tile indices in rendering order. The order is by diagonals, so that the left and upper neighbours of a
  /// tile are rendered long before it, or row by row if halos are retraced.
  std::vector<std::uint32_t> rendering_order(Halo halo) const;

 private:
  std::uint32_t width_, height_;  ///< size of the picture in samples
  std::uint32_t grid_, side_, across_, down_;
};

/// A rectangle of a tile's halo in the tile buffer, and the place in memory where a neighbouring tile has stored these
/// samples.
struct HaloPart {
  traces::Border border;
  std::uint64_t first = 0;     ///< index of the rectangle's first sample among those that the other tile stores
  std::uint32_t x = 0, y = 0;  ///< position in the tile buffer of the rectangle's first sample
  std::uint32_t across = 0, down = 0;
  /// Returns the part of the halo's rectangle that is nearest to the tile: its last `columns` columns and last `rows`
  /// rows.
  HaloPart part_nearest_tile(std::uint32_t columns, std::uint32_t rows) const;
};

/// Tiles for programs whose pixels read neighbours up to `reach` pixels away in all directions. A tile imports samples
/// only from the left and above.
///
/// So the pixels that a tile finishes are offset from its samples by `reach` to the left and up. The tile needs 2 *
/// `reach` columns and rows of its neighbours (its halo). With a reach of 1:
///
///   h h|h h h h    h  halo: samples of the tiles left, above, and above to the left
///   h F|F F F .    F  pixels finished here
///   ---+-------    .  the neighbours to the right and below finish these; at the picture's edge, this tile
///   h F|F F F .
///   h .|. . . .
///
/// A tile stores in memory its last 2 * `reach` columns, row by row (the corner comes last), then its last 2 * `reach`
/// rows.
class FinishedTiles {
 public:
  /// `side` is the desired side of a tile in pixels. Tiles that are not last in a row or column are at least as wide as
  /// a halo.
  FinishedTiles(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t reach)
      : tiles_(width, height, 1, side, std::max(1U, 2 * reach)), reach_(reach) {}

  const SampleTiles& sample_tiles() const { return tiles_; }
  std::uint32_t tile_count() const { return tiles_.tile_count(); }
  std::uint32_t tile_side() const { return tiles_.tile_side(); }
  std::uint32_t halo_width() const { return 2 * reach_; }
  /// Returns the number of samples in a row of the tile buffer: those of the halo at its left, followed by the tile's
  /// own.
  std::uint32_t row_pitch() const { return tile_side() + halo_width(); }
  std::uint32_t buffer_samples() const { return row_pitch() * row_pitch(); }
  /// Returns the largest number of pixels whose final colours one tile computes.
  std::uint32_t most_pixels() const { return (tile_side() + reach_) * (tile_side() + reach_); }
  /// Sets in `out` the rectangle of the picture whose final colours a tile computes.
  void set_finished_rect(const SampleTile& at, TileResult& out) const;
  /// Returns for which pixels a tile computes the final colours, and where their samples are in the tile buffer.
  FinishedUniforms<float> finished_uniforms(const SampleTile& at, const TileResult& out) const;
  /// Returns the indices of the samples in a rectangle of the tile buffer that begins at (x, y).
  LatticeUniforms<float> rect_sample_lattice(std::uint32_t x, std::uint32_t y, std::uint32_t across) const;

  /// Returns the number of samples that a tile stores in memory for its neighbours.
  std::uint64_t stored_samples() const { return 2 * std::uint64_t{halo_width()} * tile_side(); }
  /// Calls f(part) for each rectangle (HaloPart) of a tile's halo.
  void for_each_halo_part(const SampleTile& at, auto&& f) const {
    const std::uint32_t h = halo_width();
    if (h == 0) return;
    if (at.has_left) f(HaloPart{{at.left, kRightBorder}, 0, 0, h, h, at.height});
    if (at.has_above) f(HaloPart{{at.above, kLowerBorder}, std::uint64_t{h} * tile_side(), h, 0, at.width, h});
    if (at.has_left && at.has_above) {
      f(HaloPart{{at.above_left, kRightBorder}, std::uint64_t{h} * (tile_side() - h), 0, 0, h, h});
    }
  }
  /// Calls f(border, first, samples) for each border that other tiles read; `first` is the index of its first sample in
  /// the memory region to which the tile writes its samples.
  void for_each_export_border(const SampleTile& at, auto&& f) const {
    if (halo_width() == 0) return;
    if (at.has_right) f(kRightBorder, std::uint64_t{0}, halo_width() * at.height);
    if (at.has_below) f(kLowerBorder, std::uint64_t{halo_width()} * tile_side(), halo_width() * at.width);
  }

 private:
  const SampleTiles tiles_;
  const std::uint32_t reach_;
};

}  // namespace kernels
