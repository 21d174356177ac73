#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Every item leaves the sum so far in its pixel; the pixel's last sample completes it.
struct AverageColour {
  static constexpr std::string_view kName = "average_colour";
  static constexpr std::string_view kMeaning = "sample -> mean of its pixel's samples, clamped, in linear light";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours, pixels;
    Carried<V> red, green, blue;
    F<V> samples, inverse_samples;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
      port(NAMED(p.red));
      port(NAMED(p.green));
      port(NAMED(p.blue));
      port(NAMED(p.samples));
      port(NAMED(p.inverse_samples));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = divmod<V>(to_float(item), at.samples, at.inverse_samples);
    add<V>(at, pixel, at.colours.load(item).rgb);
  }
  /// A pixel's sample, by its number within the pixel; samples come in order.
  template <class V>
  static void add(Ports<V>& at, const DivMod<V>& pixel, const Vec3<V>& colour) {
    const M<V> first = pixel.remainder <= 0.0F;
    const auto sum = [&](Carried<V>& so_far, const F<V>& sample) {
      const F<V> next = select(first, F<V>(0.0F), so_far.get()) + clamped<V>(sample);
      so_far.set(next);
      return next;
    };
    const Vec3<V> total{sum(at.red, colour.x), sum(at.green, colour.y), sum(at.blue, colour.z)};
    at.pixels.store(to_int(pixel.quotient), {total * at.inverse_samples});
  }
};

}  // namespace kernels
