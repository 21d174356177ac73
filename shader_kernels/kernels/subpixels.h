#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// Attributes compared between pixels to find out which of their four sub-pixels need more samples; a threshold each.
/// The colour's counts where nothing else disagrees.
enum class Attribute : std::uint8_t {
  kColour,
  kObject,
  kNormal,
  kShadow,
  kTexture,
  kSecondaryObject,
  kSecondaryNormal,
  kSecondaryShadow,
  kSecondaryTexture,
  kCount
};
inline constexpr std::size_t kAttributes = static_cast<std::size_t>(Attribute::kCount);
constexpr std::array<std::string_view, kAttributes> names_of(Attribute) {
  return {"colour",           "object",           "normal",           "shadow",           "texture",
          "secondary_object", "secondary_normal", "secondary_shadow", "secondary_texture"};
}
constexpr std::uint32_t bit(Attribute attribute) { return 1U << static_cast<std::uint32_t>(attribute); }

// The verdict on a sub-pixel, four to a pixel, row by row within it: bits of the attributes that disagreed (kColour if
// none did), whether it is active, and above that its index in the list of active ones, whose items are pixel * 4 +
// sub-pixel.
inline constexpr std::uint32_t kActiveShift = kAttributes;
inline constexpr std::uint32_t kIndexShift = 12;

/// Factors of a contrast's threshold, by channel (Jin et al. 2009).
inline constexpr std::array<float, 3> kChannelFactors{1.36F, 1.02F, 2.04F};
/// A threshold that no contrast reaches.
inline constexpr float kNever = 4.0F;

/// Sub-pixels of a chunk, which executors work off at once.
inline constexpr std::uint32_t kChunk = 64;
/// Samples of an active sub-pixel; of a pixel whose sub-pixels all are.
inline constexpr std::uint32_t kExtra = 4, kWhole = 16, kWholeGrid = 4;

/// The pixels that a tile finishes, row by row, and where their centre samples lie: `pitch` to a row, from `first` on.
/// Columns and rows of samples that there are, counted as the pixels, go from `low` to `high`.
template <class V>
struct FinishedUniforms {
  F<V> width, inverse_width;
  F<V> first, pitch;
  F<V> low_x, high_x, low_y, high_y;
  static void describe(auto& f, auto&& port) {
    port(f.width, "finished.width");
    port(f.inverse_width, "finished.inverse_width");
    port(f.first, "finished.first");
    port(f.pitch, "finished.pitch");
    port(f.low_x, "finished.low_x");
    port(f.high_x, "finished.high_x");
    port(f.low_y, "finished.low_y");
    port(f.high_y, "finished.high_y");
  }
};

/// Steps from a pixel's centre sample to those of the pixels around its corner; 0 where the picture ends.
template <class V>
struct CornerSteps {
  F<V> x, y;
  M<V> has_both;
};
/// `right`, `below`: 1 for the corners there, -1 for those left or above.
template <class V>
CornerSteps<V> corner_steps(const DivMod<V>& pixel, const F<V>& right, const F<V>& below,
                            const FinishedUniforms<V>& of) {
  const F<V> x = pixel.remainder + right;
  const F<V> y = pixel.quotient + below;
  const M<V> has_x = both(of.low_x <= x, x <= of.high_x);
  const M<V> has_y = both(of.low_y <= y, y <= of.high_y);
  return {select(has_x, right, F<V>(0.0F)), select(has_y, below * of.pitch, F<V>(0.0F)), both(has_x, has_y)};
}

/// The pixel's row (quotient) and column.
template <class V>
DivMod<V> finished_pixel(const F<V>& pixel, const FinishedUniforms<V>& of) {
  return divmod<V>(pixel, of.width, of.inverse_width);
}
template <class V>
F<V> centre_sample(const DivMod<V>& pixel, const FinishedUniforms<V>& of) {
  return of.first + pixel.quotient * of.pitch + pixel.remainder;
}

template <class V>
I<V> active_bit(const I<V>& verdict) {
  return (verdict >> kActiveShift) & 1U;
}

template <class V>
Vec3<V> clamped_colour(const Vec3<V>& colour) {
  return {clamped<V>(colour.x), clamped<V>(colour.y), clamped<V>(colour.z)};
}

}  // namespace kernels
