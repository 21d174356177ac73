#include "shader_kernels/programs/wavefront/frame_program.h"

#include <algorithm>
#include <cmath>

namespace kernels {

void FrameProgram::commit_tile(const TileResult& tile) {
  picture_.resize(std::size_t{3} * width_ * height_);  // begins a new picture if the previous one was moved out
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
  if (keeps_marks_ && !tile.marks.empty()) copy_marks(tile);
}

void FrameProgram::copy_marks(const TileResult& tile) {
  const std::size_t pixels = std::size_t{tile.width} * tile.height;
  const auto grid = static_cast<std::size_t>(std::lround(std::sqrt(tile.marks.size() / pixels)));
  marks_.resize(std::size_t{width_} * height_ * grid * grid);
  const std::size_t across = tile.width * grid;
  for (std::size_t row = 0; row < tile.height * grid; ++row) {
    const auto from = tile.marks.begin() + static_cast<std::ptrdiff_t>(row * across);
    std::copy_n(from, across,
                marks_.begin() + static_cast<std::ptrdiff_t>((tile.y * grid + row) * width_ * grid + tile.x * grid));
  }
}

}  // namespace kernels
