#pragma once
#include "shader_kernels/value.h"
#include "traces/accel/memory_image.h"

namespace kernels {

template <class V>
struct DivMod {
  F<V> quotient, remainder;
};
/// Returns quotient and remainder of two integers below 2^20, computed in floating point. `inverse` is 1 / divisor.
template <class V>
DivMod<V> div_mod(const F<V>& count, const F<V>& divisor, const F<V>& inverse) {
  const F<V> quotient = floor((count + 0.5F) * inverse);
  return {quotient, count - quotient * divisor};
}

/// Mixes the bits of a 32-bit key into a hash (a finaliser with multipliers found by C. Wellons).
template <class V>
I<V> scramble_bits(const I<V>& key) {
  const I<V> a = (key ^ (key >> 16U)) * 0x7feb352dU;
  const I<V> b = (a ^ (a >> 15U)) * 0x846ca68bU;
  return b ^ (b >> 16U);
}

/// Converts a hash to a float in [0, 1), from its upper 24 bits.
template <class V>
F<V> hash_to_unit_float(const I<V>& hash) {
  return to_float(hash >> 8U) * 0x1p-24F;
}

template <class V>
M<V> has_flag(const I<V>& flags, traces::MaterialFlag bit) {
  return I<V>(0U) < (flags & static_cast<std::uint32_t>(bit));
}

/// Returns byte `byte` of a word; byte 0 is the lowest, 3 the highest.
template <class V>
I<V> extract_byte(const I<V>& word, std::uint32_t byte) {
  if (byte == 0) return word & 255U;
  if (byte == 3) return word >> 24U;
  return (word >> (8U * byte)) & 255U;
}

template <class V>
F<V> clamp_to_unit(const F<V>& x) {
  return min(max(x, F<V>(0.0F)), F<V>(1.0F));
}

/// Converts a linear channel to sRGB, both in [0, 1]. The result is exact near black, elsewhere within 0.2 / 255.
template <class V>
F<V> encode_srgb(const F<V>& x) {
  const F<V> half = sqrt(x);
  const F<V> quarter = sqrt(half);
  const F<V> curve = half * 0.58723747F + quarter * 0.77597848F - sqrt(quarter) * 0.36321595F;
  return select(x <= 0.0031308F, x * 12.92F, curve);
}

/// Returns the squared distance of two linear colours, after both are clamped to [0, 1] and sRGB-encoded.
template <class V>
F<V> encoded_distance_squared(const Vec3<V>& a, const Vec3<V>& b) {
  const auto code = [](const F<V>& x) { return encode_srgb<V>(clamp_to_unit<V>(x)); };
  const Vec3<V> apart{code(a.x) - code(b.x), code(a.y) - code(b.y), code(a.z) - code(b.z)};
  return dot(apart, apart);
}

/// Returns exp(-x) for x >= 0, with an error below 4e-6. The result is the fourth-order series of exp at x / 16,
/// inverted and squared four times.
template <class V>
F<V> exp_negative(const F<V>& x) {
  const F<V> y = x * (1.0F / 16.0F);
  const F<V> series = (((y * (1.0F / 24.0F) + 1.0F / 6.0F) * y + 0.5F) * y + 1.0F) * y + 1.0F;
  const F<V> once = 1.0F / series;
  const F<V> twice = once * once;
  const F<V> four = twice * twice;
  const F<V> eight = four * four;
  return eight * eight;
}

/// Barycentric weights of a hit in its triangle, one for each corner.
template <class V>
struct Weights {
  F<V> first, second, third;
  explicit Weights(const auto& hit) : first(1.0F - hit.u - hit.v), second(hit.u), third(hit.v) {}
  F<V> interpolate(const F<V>& a, const F<V>& b, const F<V>& c) const { return a * first + b * second + c * third; }
  Vec3<V> interpolate(const Vec3<V>& a, const Vec3<V>& b, const Vec3<V>& c) const {
    return a * first + b * second + c * third;
  }
  /// Converts the integer values at a triangle's corners to floats and interpolates them.
  F<V> interpolate_int(const I<V>& a, const I<V>& b, const I<V>& c) const {
    return interpolate(to_float(a), to_float(b), to_float(c));
  }
};

/// How a ray is reflected and refracted at a surface between two media: angles and reflectance.
template <class V>
struct Interface {
  F<V> cosine;       ///< cosine of the angle between the incoming ray and the normal
  F<V> eta;          ///< refractive index of the medium that the ray comes from, divided by that of the other medium
  F<V> inside;       ///< squared cosine of the refracted angle; negative for total internal reflection
  F<V> reflectance;  ///< Schlick's approximation of the Fresnel reflectance; 1 for total reflection
};
template <class V>
Interface<V> make_interface(const Vec3<V>& direction, const Vec3<V>& normal, const F<V>& side, const F<V>& ior) {
  const F<V> cosine = -dot(direction, normal);
  const F<V> eta = select(F<V>(0.0F) < side, 1.0F / ior, ior);
  const F<V> inside = 1.0F - eta * eta * (1.0F - cosine * cosine);
  const F<V> ratio = (ior - 1.0F) / (ior + 1.0F);
  // Schlick's formula takes the angle in the medium with the smaller refractive index.
  const F<V> away = 1.0F - select(eta <= 1.0F, cosine, sqrt(max(inside, F<V>(0.0F))));
  const F<V> squared = away * away;
  return {cosine, eta, inside, 1.0F - (1.0F - ratio * ratio) * (1.0F - squared * squared * away)};
}

}  // namespace kernels
