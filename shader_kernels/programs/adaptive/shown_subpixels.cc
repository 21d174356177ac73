#include "shader_kernels/programs/adaptive/shown_subpixels.h"

#include <algorithm>

#include "shader_kernels/kernels/subpixels.h"

namespace kernels {

ShownSubpixels::ShownSubpixels(std::uint32_t width, std::uint32_t height, std::uint32_t tiles)
    : width_(2 * width),
      height_(2 * height),
      states_((std::size_t{width_} + 2) * (std::size_t{height_} + 2)),
      colours_(std::size_t{width_} * height_),
      is_background_(colours_.size()),
      fresh_(tiles),
      next_fresh_(tiles) {}

void ShownSubpixels::begin(std::uint32_t tile, const std::vector<ShownSubpixel>& all) {
  const auto is_active = [](const ShownSubpixel& s) { return s.state.blue_why >> kRoundShift != 0; };
  next_fresh_[tile] = std::ranges::any_of(all, is_active) ? 1 : 0;
  take(all);
}

void ShownSubpixels::keep(std::uint32_t tile, const std::vector<ShownSubpixel>& found) {
  next_fresh_[tile] = found.empty() ? 0 : 1;
  found_.insert(found_.end(), found.begin(), found.end());
}

void ShownSubpixels::settle() {
  take(found_);
  found_.clear();
  fresh_.swap(next_fresh_);
}

void ShownSubpixels::take(const std::vector<ShownSubpixel>& subpixels) {
  for (const ShownSubpixel& s : subpixels) {
    states_[std::size_t{s.y + 1} * (width_ + 2) + s.x + 1] = s.state;
    colours_[std::size_t{s.y} * width_ + s.x] = s.colour;
    is_background_[std::size_t{s.y} * width_ + s.x] = s.is_background ? 1 : 0;
  }
}

std::uint32_t ShownSubpixels::active_of(std::uint32_t x, std::uint32_t y) const {
  std::uint32_t active = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::size_t at = std::size_t{2 * y + i / 2 + 1} * (width_ + 2) + 2 * x + i % 2 + 1;
    active += states_[at].blue_why >> kRoundShift != 0 ? 1 : 0;
  }
  return active;
}

void ShownSubpixels::copy_states(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                                 SubpixelRecord<float>* to) const {
  for (std::uint32_t row = 0; row < height + 2; ++row) {
    to = std::copy_n(states_.data() + std::size_t{y + row} * (width_ + 2) + x, width + 2, to);
  }
}

}  // namespace kernels
