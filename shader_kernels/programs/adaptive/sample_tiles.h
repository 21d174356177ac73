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

/// Numbers of a tile's borders that others import: its last columns, its last rows.
inline constexpr std::uint32_t kRightBorder = 0, kLowerBorder = 1;

/// Bytes that memory moves for so many records strewn over `all` bytes: a line each, as long as those are not more.
std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all);

/// A tile's part of the picture's grid of samples.
struct SampleTile {
  std::uint32_t index = 0;     ///< row by row
  std::uint32_t x = 0, y = 0;  ///< first sample
  std::uint32_t width = 0, height = 0;
  std::uint32_t left = 0, above = 0, above_left = 0;  ///< tiles there, if any
  bool has_left = false, has_above = false;
  bool has_right = false, has_below = false;
};

/// Cuts the picture's samples into square tiles of whole pixels and whole blocks.
class SampleTiles {
 public:
  /// `side`: wanted, in samples; `grid`: samples along a pixel; `block`: what a tile must be a multiple of.
  SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t grid, std::uint32_t side, std::uint32_t block);

  std::uint32_t count() const { return across_ * down_; }
  std::uint32_t across() const { return across_; }  ///< tiles
  std::uint32_t down() const { return down_; }      ///< likewise
  std::uint32_t side() const { return side_; }
  std::uint32_t grid() const { return grid_; }
  SampleTile tile(std::uint32_t index) const;
  /// Every tile behind those to its left and above, and far from them: by diagonals, or row by row.
  std::vector<std::uint32_t> order(Halo halo) const;

 private:
  std::uint32_t width_, height_;  ///< in samples
  std::uint32_t grid_, side_, across_, down_;
};

/// Samples of a tile's halo: a rectangle of the tile buffer, and where in another tile's store it comes from.
struct HaloPart {
  traces::Border border;
  std::uint64_t first = 0;     ///< sample of that tile's store
  std::uint32_t x = 0, y = 0;  ///< position in the tile buffer
  std::uint32_t across = 0, down = 0;
  /// Samples at its inner side, nearest to the tile: `columns` and `rows` of it.
  HaloPart inner(std::uint32_t columns, std::uint32_t rows) const;
};

/// Tiles of pixels that look to all sides, `reach` pixels far, while tiles look only to the left and above: what a tile
/// finishes lies `reach` further left and further up than what it takes samples of. It needs twice as many columns and
/// rows of its neighbours (its halo). With a reach of 1:
///
///   h h|h h h h    h  halo: samples of the tiles left, above, and above to the left
///   h F|F F F .    F  pixels finished here
///   ---+-------    .  the neighbours to the right and below finish these; at the picture's edge, this tile
///   h F|F F F .
///   h .|. . . .
///
/// A tile's store in memory has its last columns, row by row, so that the last of them are the corner; then its last
/// rows.
class FinishedTiles {
 public:
  /// `side`: wanted, in pixels; no tile is narrower than a halo, but the last.
  FinishedTiles(std::uint32_t width, std::uint32_t height, std::uint32_t side, std::uint32_t reach)
      : tiles_(width, height, 1, side, std::max(1U, 2 * reach)), reach_(reach) {}

  const SampleTiles& tiles() const { return tiles_; }
  std::uint32_t count() const { return tiles_.count(); }
  std::uint32_t side() const { return tiles_.side(); }
  std::uint32_t halo() const { return 2 * reach_; }
  /// Samples to a row of the tile buffer: those of the halo, then the tile's own.
  std::uint32_t pitch() const { return side() + halo(); }
  std::uint32_t samples() const { return pitch() * pitch(); }
  /// Pixels that a tile finishes, at most.
  std::uint32_t most_pixels() const { return (side() + reach_) * (side() + reach_); }
  /// Tells `out` which part of the picture a tile finishes.
  void place(const SampleTile& at, TileResult& out) const;
  /// That part of the tile buffer.
  FinishedUniforms<float> finished(const SampleTile& at, const TileResult& out) const;
  /// Samples to a row of a rectangle of the tile buffer, whose first is at `x`, `y`.
  LatticeUniforms<float> lattice(std::uint32_t x, std::uint32_t y, std::uint32_t across) const;

  /// Samples of a tile's store.
  std::uint64_t stored_samples() const { return 2 * std::uint64_t{halo()} * side(); }
  /// Calls f(part) for each part of a tile's halo.
  void for_each_part(const SampleTile& at, auto&& f) const {
    const std::uint32_t h = halo();
    if (h == 0) return;
    if (at.has_left) f(HaloPart{{at.left, kRightBorder}, 0, 0, h, h, at.height});
    if (at.has_above) f(HaloPart{{at.above, kLowerBorder}, std::uint64_t{h} * side(), h, 0, at.width, h});
    if (at.has_left && at.has_above) {
      f(HaloPart{{at.above_left, kRightBorder}, std::uint64_t{h} * (side() - h), 0, 0, h, h});
    }
  }
  /// Calls f(border, first sample of the store, samples) for each border that others read.
  void for_each_export(const SampleTile& at, auto&& f) const {
    if (halo() == 0) return;
    if (at.has_right) f(kRightBorder, std::uint64_t{0}, halo() * at.height);
    if (at.has_below) f(kLowerBorder, std::uint64_t{halo()} * side(), halo() * at.width);
  }

 private:
  const SampleTiles tiles_;
  const std::uint32_t reach_;
};

}  // namespace kernels
