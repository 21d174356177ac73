#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/wavefront/sampling.h"

namespace kernels {

/// Block sides of a frame's tiles, and what decides over them from frame to frame (Lee et al. 2016, section 3).
class RateMap {
 public:
  static constexpr std::uint8_t kCoarse = 4;  ///< block side where little changes

  explicit RateMap(const MultirateConfig& config) : config_(config) {}

  /// Rate of a tile in this frame.
  std::uint32_t block(std::uint32_t tile) const { return tiles_.empty() ? config_.block : tiles_[tile].block; }
  /// Goes on to the next frame, given what this one has found out.
  void advance(const Sampling& frame);

 private:
  struct Tile {
    std::uint8_t block = 2;
    std::uint32_t held = 0;  ///< frames for which it stays as it is
  };
  MultirateConfig config_;
  std::vector<Tile> tiles_;  ///< empty in the first frame
  std::uint32_t frame_ = 0;
};

}  // namespace kernels
