#pragma once
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "shader_kernels/programs/wavefront/tile_result.h"

namespace kernels {

/// Sub-pixels of a whole picture, between rounds of propagation. A round looks at what the rounds before have left:
/// what tiles of the same round find is taken by settle(), when all of them have been kept.
class ShownSubpixels {
 public:
  /// Begins with nothing shown, in a picture cut into `tiles` tiles.
  ShownSubpixels(std::uint32_t width, std::uint32_t height, std::uint32_t tiles);

  /// Takes all sub-pixels of tile `tile`, before the first round.
  void begin(std::uint32_t tile, const std::vector<ShownSubpixel>& all);
  /// Takes what a round has made active in it, for settle().
  void keep(std::uint32_t tile, const std::vector<ShownSubpixel>& found);
  void settle();

  /// Whether the last round has made sub-pixels of a tile active.
  bool is_fresh(std::uint32_t tile) const { return fresh_[tile] != 0; }
  /// Copies the states of `width` x `height` sub-pixels from `x`, `y` on, and of those around them, which have none
  /// where the picture ends.
  void copy_states(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                   SubpixelRecord<float>* to) const;
  const glm::vec3& colour(std::uint32_t x, std::uint32_t y) const { return colours_[std::size_t{y} * width_ + x]; }
  /// Active sub-pixels of a pixel.
  std::uint32_t active_of(std::uint32_t x, std::uint32_t y) const;
  bool is_background(std::uint32_t x, std::uint32_t y) const {
    return is_background_[std::size_t{y} * width_ + x] != 0;
  }

 private:
  void take(const std::vector<ShownSubpixel>& subpixels);

  const std::uint32_t width_, height_;         ///< in sub-pixels
  std::vector<SubpixelRecord<float>> states_;  ///< with a border of none
  std::vector<glm::vec3> colours_;
  std::vector<std::uint8_t> is_background_;
  std::vector<std::uint8_t> fresh_, next_fresh_;  ///< per tile
  std::vector<ShownSubpixel> found_;
};

}  // namespace kernels
