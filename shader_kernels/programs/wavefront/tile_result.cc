#include "shader_kernels/programs/wavefront/tile_result.h"

#include <glm/common.hpp>

namespace kernels {
glm::vec3 TileResult::colour(std::uint32_t sample) const {
  const Vec3<float>& rgb = buffer.samples.colours[sample].rgb;
  return glm::clamp(glm::vec3(rgb.x, rgb.y, rgb.z), 0.0F, 1.0F);
}

}  // namespace kernels
