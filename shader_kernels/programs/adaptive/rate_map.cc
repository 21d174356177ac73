#include "shader_kernels/programs/adaptive/rate_map.h"

namespace kernels {

void RateMap::update_rates(const Sampling& frame) {
  if (config_.rate_control == RateControl::kOff) return;
  tiles_.resize(frame.similar.size());
  const bool alternates = config_.rate_control == RateControl::kAlternate;
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    Tile& tile = tiles_[i];
    if (tile.held > 0) {
      tile.held -= 1;
      continue;
    }
    const bool is_coarse = tile.block == kCoarse;
    const bool uses_down = alternates ? frame_ % 2 == 1 : is_coarse;
    const bool coarse = frame.similar[i] >= static_cast<float>(uses_down ? config_.rate_down : config_.rate_up);
    if (is_coarse && !coarse) tile.held = config_.rate_hold;
    tile.block = coarse ? kCoarse : static_cast<std::uint8_t>(config_.block);
  }
  frame_ += 1;
}

}  // namespace kernels
