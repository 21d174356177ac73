#include "shader_kernels/programs/frame_program.h"

namespace kernels {

void FrameProgram::keep(const TileResult& tile) {
  for (std::uint32_t row = 0; row < tile.height; ++row) {
    float* to = picture_.data() + std::size_t{3} * (std::size_t{tile.y + row} * width_ + tile.x);
    for (std::uint32_t column = 0; column < tile.width; ++column) {
      const glm::vec3& from = tile.linear[std::size_t{row} * tile.width + column];
      *to++ = from.x;
      *to++ = from.y;
      *to++ = from.z;
    }
  }
  sampling_.add(tile.sampling);
}

}  // namespace kernels
