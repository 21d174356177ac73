#include "shader_kernels/programs/adaptive/sample_tiles.h"

#include <algorithm>
#include <numeric>

namespace kernels {

std::uint32_t scattered_bytes(std::uint64_t records, std::uint64_t all) {
  constexpr std::uint64_t kLine = 64;  // bytes of memory that a transfer of one record moves
  return static_cast<std::uint32_t>(std::min(records * kLine, all));
}

SampleTiles::SampleTiles(std::uint32_t width, std::uint32_t height, std::uint32_t samples_per_side, std::uint32_t side,
                         std::uint32_t block)
    : width_(width * samples_per_side), height_(height * samples_per_side), grid_(samples_per_side) {
  const std::uint32_t whole = std::lcm(samples_per_side, block);
  side_ = std::max(whole, side / whole * whole);
  across_ = (width_ + side_ - 1) / side_;
  down_ = (height_ + side_ - 1) / side_;
}

SampleTile SampleTiles::sample_tile(std::uint32_t index) const {
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

std::vector<std::uint32_t> SampleTiles::rendering_order(Halo halo) const {
  std::vector<std::uint32_t> order(tile_count());
  std::iota(order.begin(), order.end(), 0U);
  if (halo == Halo::kRetrace) return order;
  std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return i % across_ + i / across_; });
  return order;
}

HaloPart HaloPart::part_nearest_tile(std::uint32_t columns, std::uint32_t rows) const {
  HaloPart part = *this;
  part.across = std::min(across, columns);
  part.down = std::min(down, rows);
  part.x += across - part.across;
  part.y += down - part.down;
  return part;
}

void FinishedTiles::set_finished_rect(const SampleTile& at, TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  out.tile = at.index;
  out.x = at.x - left;
  out.y = at.y - above;
  out.width = at.width + left - (at.has_right ? reach_ : 0);
  out.height = at.height + above - (at.has_below ? reach_ : 0);
}

FinishedUniforms<float> FinishedTiles::finished_uniforms(const SampleTile& at, const TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  const auto width = static_cast<float>(out.width), height = static_cast<float>(out.height);
  const auto reach = static_cast<float>(reach_);
  return {.width = width,
          .inverse_width = 1.0F / width,
          .first = static_cast<float>((halo_width() - above) * row_pitch() + halo_width() - left),
          .pitch = static_cast<float>(row_pitch()),
          .low_x = at.has_left ? -reach : 0.0F,
          .high_x = at.has_right ? width + reach - 1.0F : width - 1.0F,
          .low_y = at.has_above ? -reach : 0.0F,
          .high_y = at.has_below ? height + reach - 1.0F : height - 1.0F};
}

LatticeUniforms<float> FinishedTiles::rect_sample_lattice(std::uint32_t x, std::uint32_t y,
                                                          std::uint32_t across) const {
  return {.first = static_cast<float>(y * row_pitch() + x),
          .across = static_cast<float>(across),
          .inverse_across = 1.0F / static_cast<float>(across),
          .step = 1,
          .row_step = static_cast<float>(row_pitch())};
}

}  // namespace kernels
