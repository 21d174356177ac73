#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/wavefront/sampling.h"

namespace kernels {

/// The block sides of tiles, updated from frame to frame (Lee et al. 2016, section 3).
class RateMap {
 public:
  static constexpr std::uint8_t kCoarse = 4;  ///< block side of tiles with few changes

  explicit RateMap(const MultirateConfig& config) : config_(config) {}

  /// Returns the block side of a tile in this frame.
  std::uint32_t block_side(std::uint32_t tile) const { return tiles_.empty() ? config_.block : tiles_[tile].block; }
  /// Updates the block sides for the next frame from this frame's counts.
  void advance(const Sampling& frame);

 private:
  struct Tile {
    std::uint8_t block = 2;
    std::uint32_t held = 0;  ///< frames for which the block side is held
  };
  MultirateConfig config_;
  std::vector<Tile> tiles_;  ///< empty in the first frame
  std::uint32_t frame_ = 0;
};

}  // namespace kernels
