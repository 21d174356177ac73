#include "shader_kernels/programs/adaptive/finished_tiles.h"

#include <algorithm>

namespace kernels {

HaloPart HaloPart::inner(std::uint32_t columns, std::uint32_t rows) const {
  HaloPart part = *this;
  part.across = std::min(across, columns);
  part.down = std::min(down, rows);
  part.x += across - part.across;
  part.y += down - part.down;
  return part;
}

void FinishedTiles::place(const SampleTile& at, TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  out.tile = at.index;
  out.x = at.x - left;
  out.y = at.y - above;
  out.width = at.width + left - (at.has_right ? reach_ : 0);
  out.height = at.height + above - (at.has_below ? reach_ : 0);
}

FinishedUniforms<float> FinishedTiles::finished(const SampleTile& at, const TileResult& out) const {
  const std::uint32_t left = at.has_left ? reach_ : 0;
  const std::uint32_t above = at.has_above ? reach_ : 0;
  const auto width = static_cast<float>(out.width), height = static_cast<float>(out.height);
  const auto reach = static_cast<float>(reach_);
  return {.width = width,
          .inverse_width = 1.0F / width,
          .first = static_cast<float>((halo() - above) * pitch() + halo() - left),
          .pitch = static_cast<float>(pitch()),
          .low_x = at.has_left ? -reach : 0.0F,
          .high_x = at.has_right ? width + reach - 1.0F : width - 1.0F,
          .low_y = at.has_above ? -reach : 0.0F,
          .high_y = at.has_below ? height + reach - 1.0F : height - 1.0F};
}

LatticeUniforms<float> FinishedTiles::lattice(std::uint32_t x, std::uint32_t y, std::uint32_t across) const {
  return {.first = static_cast<float>(y * pitch() + x),
          .across = static_cast<float>(across),
          .inverse_across = 1.0F / static_cast<float>(across),
          .step = 1,
          .row_step = static_cast<float>(pitch())};
}

}  // namespace kernels
