#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/vec3.h"

namespace kernels {

/// Point of the unit square that one of a surface's rays for an effect stands for. The rays of a surface lie evenly in
/// the square, which a hash shifts from surface to surface.
template <class V>
struct DrawUniforms {
  F<V> x, y;  ///< before the shift
  I<V> seed;  ///< the frame's and the effect's
  static void describe(auto& d, auto&& port) {
    port(d.x, "draw.x");
    port(d.y, "draw.y");
    port(d.seed, "draw.seed");
  }
};

template <class V>
struct DrawnPoint {
  F<V> x, y;
};

/// The hash is that of the ray that found the surface. A primary ray has the same bits whatever tile or order its
/// sample belongs to, and whoever traces it.
template <class V>
DrawnPoint<V> drawn(const Vec3<V>& direction, const DrawUniforms<V>& draw) {
  const I<V> key = (bits_of(direction.x) * 0x9e3779b1U) ^ (bits_of(direction.y) * 0x85ebca77U) ^
                   (bits_of(direction.z) * 0xc2b2ae3dU) ^ draw.seed;
  const I<V> first = scrambled<V>(key);
  const F<V> x = unit_float<V>(first) + draw.x;
  const F<V> y = unit_float<V>(scrambled<V>(first ^ 0x9e3779b9U)) + draw.y;
  return {x - floor(x), y - floor(y)};
}

/// Sine of so many half turns, from -1 to 1: two parabolas, within 0.0012.
template <class V>
F<V> sine_of(const F<V>& half_turns) {
  const F<V> arch = half_turns * 4.0F * (1.0F - abs(half_turns));
  return arch * (abs(arch) * 0.225F + 0.775F);
}

/// The point of the unit disc for one of the unit square, areas alike: `x` is its angle, `y` its squared distance from
/// the middle.
template <class V>
DrawnPoint<V> on_disc(const DrawnPoint<V>& square) {
  const F<V> half_turns = square.x * 2.0F - 1.0F;
  const F<V> quarter_on = half_turns + 0.5F;
  const F<V> radius = sqrt(square.y);
  return {radius * sine_of<V>(select(quarter_on < 1.0F, quarter_on, quarter_on - 2.0F)),
          radius * sine_of<V>(half_turns)};
}

/// Two unit vectors across a unit vector and each other (Duff et al. 2017).
template <class V>
struct Across {
  Vec3<V> x, y;
};
template <class V>
Across<V> across(const Vec3<V>& normal) {
  const F<V> sign = select(normal.z < 0.0F, F<V>(-1.0F), F<V>(1.0F));
  const F<V> a = -1.0F / (sign + normal.z);
  const F<V> b = normal.x * normal.y * a;
  const F<V> x = sign * normal.x;
  return {{1.0F + x * normal.x * a, sign * b, -x}, {b, sign + normal.y * normal.y * a, -normal.y}};
}

}  // namespace kernels
