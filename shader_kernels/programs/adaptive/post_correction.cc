#include "shader_kernels/programs/adaptive/post_correction.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "shader_kernels/kernels/attributes.h"

namespace kernels {

PostCorrection::PostCorrection(const UndersampleConfig& config, std::uint32_t width, std::uint32_t height,
                               std::uint32_t tile_side)
    : config_(config), width_(width), height_(height), side_(tile_side), across_((width + tile_side - 1) / tile_side) {
  if (scans() == 0) return;
  identities_.resize((std::size_t{width} + 2) * (std::size_t{height} + 2));
  rounds_.resize(identities_.size());
  colours_.resize(std::size_t{width} * height);
}

std::uint32_t PostCorrection::scans() const {
  if (config_.correction == Correction::kOff) return 0;
  return config_.correction == Correction::kTwo ? 2 : 4;
}

void PostCorrection::keep(const TileResult& tile, const SampleTile& at) {
  if (scans() == 0) return;
  for (std::uint32_t row = 0; row < at.height; ++row) {
    for (std::uint32_t column = 0; column < at.width; ++column) {
      const ShownSample& sample = tile.shown[std::size_t{row} * at.width + column];
      identities_[index_of(at.x + column, at.y + row)] = sample.identity;
      colours_[std::size_t{at.y + row} * width_ + at.x + column] = sample.colour;
    }
  }
}

void PostCorrection::begin() {
  all_.clear();
  std::ranges::fill(rounds_, std::uint16_t{0});
}

/// Finds the suspects at position `step` of all lines.
void PostCorrection::find(const Scan& scan, std::uint32_t step) {
  const std::uint32_t lines = scan.is_along_y ? width_ : height_;
  const std::uint32_t length = scan.is_along_y ? height_ : width_;
  const std::uint32_t at = scan.is_backward ? length - 1 - step : step;
  const std::uint32_t along = scan.is_along_y ? width_ + 2 : 1;
  const std::uint32_t across = scan.is_along_y ? 1 : width_ + 2;
  const std::uint32_t ahead = scan.is_backward ? 0 - along : along;
  line_.resize(lines);
  found_.resize(lines + 1);
  const std::uint32_t first = scan.is_along_y ? index_of(0, at) : index_of(at, 0);
  for (std::uint32_t line = 0; line < lines; ++line) line_[line] = first + line * across;

  const bool eight = config_.neighbours == Neighbourhood::kEight;
  const auto run = [&]<class K>(K) {
    typename K::template Ports<float> ports;
    ports.samples.bind(line_.data());
    ports.identities.bind(identities_.data());
    ports.suspects.bind(found_.data());
    ports.step = ahead;
    ports.line_step = across;
    for (std::uint32_t line = 0; line < lines; ++line) K::template body<float>(line, ports);
    return ports.suspect_count.value;
  };
  const std::uint32_t count = eight ? run(FindSuspects<true>{}) : run(FindSuspects<false>{});
  fresh_.clear();
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t found = found_[i];
    const std::uint32_t x = found % (width_ + 2) - 1;
    const std::uint32_t y = found / (width_ + 2) - 1;
    std::uint32_t before = rounds_[found - ahead];
    if (eight) {
      before = std::max(
          {before, std::uint32_t{rounds_[found - ahead - across]}, std::uint32_t{rounds_[found - ahead + across]}});
    }
    constexpr std::uint32_t kMost = std::numeric_limits<std::uint16_t>::max();
    rounds_[found] = static_cast<std::uint16_t>(std::min(before + 1, kMost));
    fresh_.push_back({y / side_ * across_ + x / side_, rounds_[found], x, y});
  }
}

void PostCorrection::settle(const Found& found) {
  for (std::size_t i = 0; i < fresh_.size(); ++i) {
    const Suspect& s = fresh_[i];
    identities_[index_of(s.x, s.y)] = found.identities[i];
    colours_[std::size_t{s.y} * width_ + s.x] = found.colours[i];
  }
  all_.insert(all_.end(), fresh_.begin(), fresh_.end());
}

void PostCorrection::end() {
  std::ranges::stable_sort(all_, {}, [](const Suspect& s) { return std::tuple(s.tile, s.round); });
}

std::span<const PostCorrection::Suspect> PostCorrection::suspects_of(std::uint32_t tile) const {
  const auto first = std::ranges::lower_bound(all_, tile, {}, &Suspect::tile);
  return {first, std::ranges::upper_bound(first, all_.end(), tile, {}, &Suspect::tile)};
}

}  // namespace kernels
