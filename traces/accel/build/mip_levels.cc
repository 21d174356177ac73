#include "traces/accel/build/mip_levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "sim/error.h"
#include "traces/scene/srgb.h"

namespace traces {
namespace {

constexpr std::size_t kChannels = 4;

/// A linear texel of four channels, R first; 65535 is 1.
using WideTexel = std::array<std::uint16_t, kChannels>;
struct WideTexture {
  std::uint32_t width = 0, height = 0;
  std::vector<WideTexel> texels;
};

/// Conversion between the codes of an 8-bit channel and linear values.
class Encoding {
 public:
  explicit Encoding(bool srgb) {
    for (std::size_t code = 0; code < values_.size(); ++code) {
      const double stored = static_cast<double>(code) / 255;
      values_[code] = static_cast<std::uint16_t>(std::lround(65535 * (srgb ? srgb_to_linear(stored) : stored)));
    }
  }
  std::uint16_t value(std::uint32_t code) const { return values_[code]; }
  /// Returns the code with the nearest value.
  std::uint32_t code(std::uint16_t value) const {
    const auto above = std::ranges::lower_bound(values_, value);
    const bool is_below = above != values_.begin() && value - *(above - 1) < *above - value;
    return static_cast<std::uint32_t>(above - values_.begin()) - (is_below ? 1U : 0U);
  }

 private:
  std::array<std::uint16_t, 256> values_{};
};

/// The texels along one axis that a texel of the next level covers, and their weights.
struct Cover {
  std::uint32_t first = 0;
  std::array<std::uint64_t, 3> weights{};
  std::uint64_t sum() const { return weights[0] + weights[1] + weights[2]; }
};
Cover cover_of(std::uint32_t size, std::uint32_t i) {
  if (size == 1) return {0, {1, 0, 0}};
  const std::uint32_t half = size / 2;
  if (size % 2 == 0) return {2 * i, {1, 1, 0}};
  return {2 * i, {half - i, half, i + 1}};
}

/// Returns the next level of the texture whose texels are `at(x, y)`.
WideTexture halved(std::uint32_t width, std::uint32_t height, auto&& at) {
  WideTexture half{std::max(1U, width / 2), std::max(1U, height / 2), {}};
  half.texels.reserve(std::size_t{half.width} * half.height);
  for (std::uint32_t y = 0; y < half.height; ++y) {
    const Cover rows = cover_of(height, y);
    for (std::uint32_t x = 0; x < half.width; ++x) {
      const Cover columns = cover_of(width, x);
      std::array<std::uint64_t, kChannels> sums{};
      for (std::uint32_t j = 0; j < 3; ++j) {
        for (std::uint32_t i = 0; i < 3; ++i) {
          const std::uint64_t weight = rows.weights[j] * columns.weights[i];
          if (weight == 0) continue;
          const WideTexel texel = at(columns.first + i, rows.first + j);
          for (std::size_t k = 0; k < kChannels; ++k) sums[k] += weight * texel[k];
        }
      }
      const std::uint64_t all = rows.sum() * columns.sum();
      WideTexel& mean = half.texels.emplace_back();
      for (std::size_t k = 0; k < kChannels; ++k) mean[k] = static_cast<std::uint16_t>((sums[k] + all / 2) / all);
    }
  }
  return half;
}

/// Encodings of the colour and alpha channels.
struct Encodings {
  explicit Encodings(bool srgb) : colour(srgb), alpha(false) {}
  const Encoding& of(std::size_t channel) const { return channel < 3 ? colour : alpha; }
  WideTexel decoded(std::uint32_t texel) const {
    WideTexel wide;
    for (std::size_t k = 0; k < kChannels; ++k) wide[k] = of(k).value((texel >> (8 * k)) & 255U);
    return wide;
  }
  std::uint32_t encoded(const WideTexel& wide) const {
    std::uint32_t texel = 0;
    for (std::size_t k = 0; k < kChannels; ++k) texel |= of(k).code(wide[k]) << (8 * k);
    return texel;
  }
  Encoding colour, alpha;
};

}  // namespace

std::vector<Texture> mip_chain(const Texture& texture) {
  static const Encodings kSrgb(true), kLinear(false);
  const Encodings& encodings = texture.srgb ? kSrgb : kLinear;
  std::vector<Texture> chain{texture};
  WideTexture wide;
  while (chain.back().width > 1 || chain.back().height > 1) {
    const Texture& above = chain.back();
    const auto first = [&](std::uint32_t x, std::uint32_t y) {
      return encodings.decoded(above.texels[std::size_t{y} * above.width + x]);
    };
    const auto later = [&](std::uint32_t x, std::uint32_t y) { return wide.texels[std::size_t{y} * wide.width + x]; };
    wide = chain.size() == 1 ? halved(above.width, above.height, first) : halved(above.width, above.height, later);
    Texture level{.name = texture.name,
                  .width = wide.width,
                  .height = wide.height,
                  .texels = {},
                  .srgb = texture.srgb,
                  .wrap_u = texture.wrap_u,
                  .wrap_v = texture.wrap_v,
                  .filter = texture.filter};
    level.texels.reserve(wide.texels.size());
    for (const WideTexel& texel : wide.texels) level.texels.push_back(encodings.encoded(texel));
    chain.push_back(std::move(level));
  }
  return chain;
}

void add_mip_levels(MaterialTables& materials, MemoryImage& image) {
  std::vector<std::uint32_t> first;
  std::vector<Texture> levels;
  for (const Texture& texture : image.textures) {
    first.push_back(static_cast<std::uint32_t>(levels.size()));
    std::vector<Texture> chain = mip_chain(texture);
    image.mip_levels.resize(levels.size() + chain.size(), 0);
    image.mip_levels[first.back()] = static_cast<std::uint32_t>(chain.size());
    std::ranges::move(chain, std::back_inserter(levels));
  }
  if (levels.size() > kMostMipLevels) {
    throw sim::InputError("the scene's textures have " + std::to_string(levels.size()) + " mip levels; at most " +
                          std::to_string(kMostMipLevels) + " are allowed with render.mip_maps: on");
  }
  image.textures = std::move(levels);
  const auto rename = [&](std::uint32_t& texture) {
    if (texture != kNoTexture) texture = first[texture];
  };
  rename(image.white);
  for (MaterialRecord& record : materials.records) rename(record.base_texture);
  for (MaterialDetailRecord& detail : materials.details) {
    rename(detail.normal_texture);
    rename(detail.occlusion_texture);
    rename(detail.metal_rough_texture);
    rename(detail.emission_texture);
  }
}

}  // namespace traces
