#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// Bilinear, decoded before it is blended. Texel (0, 0) is at the top left, where v is 0.
struct ShadeTextured {
  static constexpr std::string_view kName = "shade_textured";
  static constexpr std::string_view kMeaning = "textured surface -> base colour times a bilinear fetch";
  template <class V>
  struct Ports {
    Local<V, WordRecord> textured;
    Local<V, TexcoordRecord> texcoords;
    Local<V, MatteRecord> mattes;
    Table<V, AxisRecord> axes;  ///< two per texture
    Texels<V> texels;
    static void describe(auto& p, auto&& port) {
      port(p.textured, "textured");
      port(p.texcoords, "texcoords");
      port(p.mattes, "mattes");
      port(p.axes, "axes");
      port(p.texels, "texels");
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.textured.load(item).word;
    const TexcoordRecord<V> coordinates = at.texcoords.load(slot);
    const I<V> axis = coordinates.texture << 1U;
    const Pair<V> x = neighbours<V>(coordinates.u, at.axes.load(axis));
    const Pair<V> y = neighbours<V>(coordinates.v, at.axes.load(axis + 1U));
    const FootprintRecord<V> f =
        at.texels.load(coordinates.texture, (y.first << 16U) | x.first, (y.second << 16U) | x.second);
    const Vec3<V> upper = blend<V>(colour<V>(f.at00), colour<V>(f.at10), x.weight);
    const Vec3<V> lower = blend<V>(colour<V>(f.at01), colour<V>(f.at11), x.weight);
    const MatteRecord<V> matte = at.mattes.load(slot);
    at.mattes.store(slot, {matte.diffuse * blend<V>(upper, lower, y.weight), matte.classes});
  }

 private:
  /// The two texels around a coordinate, and how much of the second.
  template <class V>
  struct Pair {
    I<V> first, second;
    F<V> weight;
  };
  template <class V>
  static Pair<V> neighbours(const F<V>& coordinate, const AxisRecord<V>& axis) {
    const F<V> bounded = min(max(coordinate, axis.low), axis.high);
    const F<V> folded = bounded - floor(bounded * axis.inverse_period) * axis.period;
    const F<V> texel = min(folded, 2.0F - folded) * axis.size - 0.5F;
    const F<V> first = floor(texel);
    const F<V> second = first + 1.0F;
    return {to_int(select(first < 0.0F, axis.below, first)), to_int(select(axis.last < second, axis.above, second)),
            texel - first};
  }
  template <class V>
  static Vec3<V> colour(const I<V>& rgba) {
    const auto channel = [](const I<V>& bits) { return decoded<V>(to_float(bits) * (1.0F / 255.0F)); };
    return {channel(rgba & 255U), channel((rgba >> 8U) & 255U), channel((rgba >> 16U) & 255U)};
  }
  template <class V>
  static Vec3<V> blend(const Vec3<V>& a, const Vec3<V>& b, const F<V>& weight) {
    return a + (b - a) * weight;
  }
};

}  // namespace kernels
