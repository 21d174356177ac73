#include "shader_kernels/programs/adaptive/sample_tiles.h"

#include <algorithm>
#include <numeric>

namespace kernels {

std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all) {
  constexpr std::uint64_t kLine = 64;  // what a record alone costs of memory
  return static_cast<std::uint32_t>(std::min(records * kLine, all));
}

SampleTiles::SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t grid, std::uint32_t side,
                         std::uint32_t block)
    : width_(width * grid), height_(height * grid), grid_(grid) {
  const std::uint32_t whole = std::lcm(grid, block);
  side_ = std::max(whole, side / whole * whole);
  across_ = (width_ + side_ - 1) / side_;
  down_ = (height_ + side_ - 1) / side_;
}

SampleTile SampleTiles::tile(std::uint32_t index) const {
  SampleTile t;
  const std::uint32_t column = index % across_;
  const std::uint32_t row = index / across_;
  t.index = index;
  t.x = column * side_;
  t.y = row * side_;
  t.width = std::min(side_, width_ - t.x);
  t.height = std::min(side_, height_ - t.y);
  t.has_left = column > 0;
  t.has_above = row > 0;
  t.has_right = column + 1 < across_;
  t.has_below = row + 1 < down_;
  if (t.has_left) t.left = index - 1;
  if (t.has_above) t.above = index - across_;
  if (t.has_left && t.has_above) t.above_left = index - across_ - 1;
  return t;
}

std::vector<std::uint32_t> SampleTiles::order(Halo halo) const {
  std::vector<std::uint32_t> order(count());
  std::iota(order.begin(), order.end(), 0U);
  if (halo == Halo::kRetrace) return order;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return i % across_ + i / across_; });
  return order;
}

}  // namespace kernels
