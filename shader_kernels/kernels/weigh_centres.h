#pragma once
#include <string_view>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

/// Share of a pixel's inactive sub-pixels, a quarter each: the colour at the pixel's centre or, with kBilinear,
/// that between the centres around the sub-pixel's own.
template <bool kBilinear>
struct WeighCentres {
  static constexpr std::string_view kName = kBilinear ? "weigh_centres_bilinear" : "weigh_centres";
  static constexpr std::string_view kMeaning = "pixel -> share of its sub-pixels that need no more samples";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, WordRecord> verdicts;
    Local<V, ColourRecord> colours, pixels;
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.verdicts));
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item), at.finished);
    const F<V> own = centre_sample<V>(pixel, at.finished);
    const Vec3<V> centre = clamped_colour<V>(at.colours.load(to_int(own)).rgb);
    const I<V> first = item << 2U;
    if constexpr (kBilinear) {
      Vec3<V> sum{0.0F, 0.0F, 0.0F};
      for (std::uint32_t i = 0; i < 4; ++i) {
        const CornerSteps<V> step =
            corner_steps<V>(pixel, F<V>((i & 1U) != 0 ? 1.0F : -1.0F), F<V>((i & 2U) != 0 ? 1.0F : -1.0F), at.finished);
        const Vec3<V> beside = clamped_colour<V>(at.colours.load(to_int(own + step.x)).rgb);
        const Vec3<V> above = clamped_colour<V>(at.colours.load(to_int(own + step.y)).rgb);
        const Vec3<V> corner = clamped_colour<V>(at.colours.load(to_int(own + step.x + step.y)).rgb);
        const F<V> weight =
            0.015625F - to_float(active_bit<V>(at.verdicts.load(first + i).word)) * 0.015625F;  // 1/4 of 1/16
        sum = sum + (centre * F<V>(9.0F) + (beside + above) * F<V>(3.0F) + corner) * weight;
      }
      at.pixels.store(item, {sum});
    } else {
      I<V> active = active_bit<V>(at.verdicts.load(first).word);
      for (std::uint32_t i = 1; i < 4; ++i) active = active + active_bit<V>(at.verdicts.load(first + i).word);
      at.pixels.store(item, {centre * (1.0F - to_float(active) * 0.25F)});
    }
  }
};

}  // namespace kernels
