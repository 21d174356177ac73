#pragma once
#include <cstdint>
#include <vector>

#include "shader_kernels/programs/adaptive/adaptive_config.h"
#include "shader_kernels/programs/wavefront/sampling.h"

namespace kernels {

/// Block sides of all tiles in the program multirate. The results of one frame determine the block sides of the next
/// frame (Lee et al. 2016, section 3).
class RateMap {
 public:
  static constexpr std::uint8_t kCoarse = 4;  ///< block side of tiles whose samples were similar in the previous frame

  explicit RateMap(const MultirateConfig& config) : config_(config) {}

  /// Returns the side in samples of a tile's blocks in this frame.
  std::uint32_t block_side(std::uint32_t tile) const { return tiles_.empty() ? config_.block : tiles_[tile].block; }
  /// Chooses the block sides of the next frame from the counts of this frame.
  void update_rates(const Sampling& frame);

 private:
  struct Tile {
    std::uint8_t block = 2;
    std::uint32_t held = 0;  ///< number of frames for which the block side must not change
  };
  MultirateConfig config_;
  std::vector<Tile> tiles_;  ///< state of each tile; empty in the first frame
  std::uint32_t frame_ = 0;
};

}  // namespace kernels
