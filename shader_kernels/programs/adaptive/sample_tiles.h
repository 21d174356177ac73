#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"

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

}  // namespace kernels
