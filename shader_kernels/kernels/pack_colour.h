#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// The frame buffer's RGBA8 of a colour whose channels are in [0, 1].
template <class V>
I<V> encoded_pixel(const Vec3<V>& colour) {
  const auto byte = [](const F<V>& x) { return to_int(encoded<V>(x) * 255.0F + 0.5F); };
  return byte(colour.x) | (byte(colour.y) << 8U) | (byte(colour.z) << 16U) | 0xff000000U;
}

struct PackColour {
  static constexpr std::string_view kName = "pack_colour";
  static constexpr std::string_view kMeaning = "pixel -> the frame buffer's RGBA8, sRGB-encoded";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> pixels;
    Local<V, WordRecord> packed;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.pixels));
      port(NAMED(p.packed));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Vec3<V> colour = at.pixels.load(item).rgb;
    at.packed.store(item, {encoded_pixel<V>({clamped<V>(colour.x), clamped<V>(colour.y), clamped<V>(colour.z)})});
  }
};

/// As pack_colour, behind a part that has clamped the pixel.
struct PackClamped {
  using Of = PackColour;
  template <class V>
  using Ports = PackColour::Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.packed.store(item, {encoded_pixel<V>(at.pixels.load(item).rgb)});
  }
};

}  // namespace kernels
