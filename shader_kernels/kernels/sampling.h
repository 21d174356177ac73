#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Four texels around a point and how much of each.
template <class V>
struct Sample {
  FootprintRecord<V> texels;
  F<V> right, lower;  ///< weight of the right and of the lower two
  /// Blends what `channel` makes of each texel's bits.
  F<V> blend(auto&& channel) const {
    const F<V> upper_left = channel(texels.at00), lower_left = channel(texels.at01);
    const F<V> upper = upper_left + (channel(texels.at10) - upper_left) * right;
    const F<V> low = lower_left + (channel(texels.at11) - lower_left) * right;
    return upper + (low - upper) * lower;
  }
  /// Channel 0 (red) to 3 (alpha) of a linear texture.
  F<V> linear(std::uint32_t channel) const {
    return blend([&](const I<V>& rgba) { return to_float(byte_of<V>(rgba, channel)) * (1.0F / 255.0F); });
  }
  /// Red, green and blue of an sRGB texture, decoded before they are blended.
  Vec3<V> colour() const { return {decoded_channel(0), decoded_channel(1), decoded_channel(2)}; }

 private:
  F<V> decoded_channel(std::uint32_t channel) const {
    return blend([&](const I<V>& rgba) { return decoded<V>(to_float(byte_of<V>(rgba, channel)) * (1.0F / 255.0F)); });
  }
};

/// The two texels around a coordinate, and how much of the second.
template <class V>
struct Neighbours {
  I<V> first, second;
  F<V> weight;
};
template <class V>
Neighbours<V> neighbours(const F<V>& coordinate, const AxisRecord<V>& axis) {
  const F<V> bounded = min(max(coordinate, axis.low), axis.high);
  const F<V> folded = bounded - floor(bounded * axis.inverse_period) * axis.period;
  const F<V> texel = min(folded, 2.0F - folded) * axis.size - axis.offset;
  const F<V> first = floor(texel);
  const F<V> second = first + (axis.offset + axis.offset);
  return {to_int(select(first < 0.0F, axis.below, first)),
          to_int(select(axis.last < second, axis.last - axis.below, second)), texel - first};
}

/// Looks up a texture. Texel (0, 0) is at the top left, where v is 0. `axes`: two per texture.
template <class V>
Sample<V> sample(const Table<V, AxisRecord>& axes, const Texels<V>& texels, const I<V>& texture, const F<V>& u,
                 const F<V>& v) {
  const I<V> axis = texture << 1U;
  const Neighbours<V> x = neighbours<V>(u, axes.load(axis));
  const Neighbours<V> y = neighbours<V>(v, axes.load(axis + 1U));
  return {texels.load(texture, (y.first << 16U) | x.first, (y.second << 16U) | x.second), x.weight, y.weight};
}

/// Ports of executors that look up textures of detailed surfaces; `stream` is the one that they work on.
template <class V>
struct DetailPorts {
  Local<V, WordRecord> stream;
  Local<V, DiffuseRecord> mattes;
  Local<V, TexcoordRecord> texcoords;
  Local<V, TangentRecord> tangents;
  Table<V, AxisRecord> axes;
  Texels<V> texels;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.stream));
    port(NAMED(p.mattes));
    port(NAMED(p.texcoords));
    port(NAMED(p.tangents));
    port(NAMED(p.axes));
    port(NAMED(p.texels));
  }
  /// Looks up a texture with the first texture coordinates, or the second if the surface's classes have that bit.
  Sample<V> look_up(const I<V>& texture, const I<V>& classes, traces::MaterialFlag second, const F<V>& u, const F<V>& v,
                    const TangentRecord<V>& other) const {
    const M<V> use_second = has<V>(classes, second);
    return sample<V>(axes, texels, texture, select(use_second, other.u, u), select(use_second, other.v, v));
  }
};

}  // namespace kernels
