#include "traces/scene/texels.h"

#include <array>

namespace traces {

glm::vec4 mean_texel(const Texture& texture) {
  std::array<std::array<std::uint64_t, 256>, 4> counts{};
  for (const std::uint32_t texel : texture.texels) {
    for (std::size_t k = 0; k < 4; ++k) ++counts[k][(texel >> (8 * k)) & 255U];
  }
  glm::vec4 mean;
  for (std::size_t k = 0; k < 4; ++k) {
    double sum = 0;
    for (std::size_t i = 0; i < 256; ++i) {
      const double stored = static_cast<double>(i) / 255;
      sum += static_cast<double>(counts[k][i]) * (texture.srgb && k < 3 ? srgb_to_linear(stored) : stored);
    }
    mean[static_cast<int>(k)] = static_cast<float>(sum / static_cast<double>(texture.texels.size()));
  }
  return mean;
}

}  // namespace traces
