#pragma once
#include <string_view>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

/// 16 items per listed pixel, the cells of its 4 x 4 row by row: adds the samples of its active sub-pixels, in the
/// order in which average_colour adds those of full:16, to what weigh_centres has left there. Every item leaves the sum
/// so far; the last one completes it.
struct SumSubpixels {
  static constexpr std::string_view kName = "sum_subpixels";
  static constexpr std::string_view kMeaning = "cell of a pixel -> its sample's share of the pixel";
  template <class V>
  struct Ports {
    Local<V, WordRecord> listed, verdicts;
    Local<V, ColourRecord> colours, pixels;
    Carried<V> red, green, blue, base_red, base_green, base_blue;
    F<V> first_sample;  ///< where the colours of the first sub-pixel in the list lie
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.listed));
      port(NAMED(p.verdicts));
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
      port(NAMED(p.red));
      port(NAMED(p.green));
      port(NAMED(p.blue));
      port(NAMED(p.base_red));
      port(NAMED(p.base_green));
      port(NAMED(p.base_blue));
      port(NAMED(p.first_sample));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> pixel = at.listed.load(item >> 4U).word;
    const I<V> subpixel = ((item >> 2U) & 2U) | ((item >> 1U) & 1U);
    const I<V> sample = ((item >> 1U) & 2U) | (item & 1U);
    const I<V> verdict = at.verdicts.load((pixel << 2U) | subpixel).word;
    const M<V> is_active = active_bit<V>(verdict) == 1U;
    const I<V> index = ((verdict >> kIndexShift) << 2U) | sample;
    const Vec3<V> colour = at.colours.load(to_int(at.first_sample + to_float(index))).rgb;
    const Vec3<V> centre = at.pixels.load(pixel).rgb;
    const M<V> first = (item & 15U) == 0U;
    const auto sum = [&](Carried<V>& so_far, Carried<V>& base, const F<V>& more, const F<V>& begin) {
      const F<V> next = select(first, F<V>(0.0F), so_far.get()) + select(is_active, clamped<V>(more), F<V>(0.0F));
      so_far.set(next);
      const F<V> kept = select(first, begin, base.get());
      base.set(kept);
      return next * 0.0625F + kept;
    };
    at.pixels.store(pixel,
                    {{sum(at.red, at.base_red, colour.x, centre.x), sum(at.green, at.base_green, colour.y, centre.y),
                      sum(at.blue, at.base_blue, colour.z, centre.z)}});
  }
};

}  // namespace kernels
