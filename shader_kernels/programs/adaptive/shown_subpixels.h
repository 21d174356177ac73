#pragma once
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Colours and states of all sub-pixels of a picture, between rounds of propagation. A round reads the results of
/// earlier rounds; results of its own are applied by settle() after all its tiles.
class ShownSubpixels {
 public:
  /// Begins without active sub-pixels, for a picture of `tiles` tiles.
  ShownSubpixels(std::uint32_t width, std::uint32_t height, std::uint32_t tiles);

  /// Stores all sub-pixels of a tile, before the first round.
  void begin(std::uint32_t tile, const std::vector<ShownSubpixel>& all);
  /// Stores the sub-pixels that a round made active in a tile; settle() applies them.
  void keep(std::uint32_t tile, const std::vector<ShownSubpixel>& found);
  void settle();

  /// True if the last round made sub-pixels of the tile active.
  bool is_fresh(std::uint32_t tile) const { return fresh_[tile] != 0; }
  /// Copies the states of `width` x `height` sub-pixels at (x, y), and of one more on each side. Beyond the edge of the
  /// picture they are inactive.
  void copy_states(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                   SubpixelRecord<float>* to) const;
  const glm::vec3& colour(std::uint32_t x, std::uint32_t y) const { return colours_[std::size_t{y} * width_ + x]; }
  /// Returns the number of a pixel's active sub-pixels.
  std::uint32_t active_of(std::uint32_t x, std::uint32_t y) const;
  bool is_background(std::uint32_t x, std::uint32_t y) const {
    return is_background_[std::size_t{y} * width_ + x] != 0;
  }

 private:
  void take(const std::vector<ShownSubpixel>& subpixels);

  const std::uint32_t width_, height_;         ///< in sub-pixels
  std::vector<SubpixelRecord<float>> states_;  ///< with a border of inactive ones
  std::vector<glm::vec3> colours_;
  std::vector<std::uint8_t> is_background_;
  std::vector<std::uint8_t> fresh_, next_fresh_;  ///< per tile
  std::vector<ShownSubpixel> found_;
};

}  // namespace kernels
