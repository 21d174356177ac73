#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace kernels {

// The value type of kernels. A kernel is written once over a type V, and used with two types. With V = float it
// computes: F<V> is float, I<V> a 32-bit unsigned integer, M<V> bool. With V = Recorded each operation becomes a node
// of a dataflow graph (recorder.h). Both types have exactly the operations of Op in graph.h. The only control flow is
// select(), because an array loop has no branches.

template <class V>
struct Reading;

template <>
struct Reading<float> {
  using Float = float;
  using Int = std::uint32_t;
  using Mask = bool;
};

template <class V>
using F = typename Reading<V>::Float;
template <class V>
using I = typename Reading<V>::Int;
template <class V>
using M = typename Reading<V>::Mask;

inline float sqrt(float x) { return std::sqrt(x); }
inline float floor(float x) { return std::floor(x); }
inline float abs(float x) { return std::fabs(x); }
inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }

inline float to_float(std::uint32_t x) { return static_cast<float>(x); }
/// Converts to an integer, rounding towards zero. Returns 0 if the result does not fit in 32 bits.
inline std::uint32_t to_int(float x) { return x >= 0 && x < 0x1p32F ? static_cast<std::uint32_t>(x) : 0; }
/// Returns the 32 bits of a float, unchanged. from_bits() is the inverse.
inline std::uint32_t bits_of(float x) { return std::bit_cast<std::uint32_t>(x); }
inline float from_bits(std::uint32_t x) { return std::bit_cast<float>(x); }

inline bool logical_and(bool a, bool b) { return a & b; }
inline bool logical_or(bool a, bool b) { return a | b; }
inline float select(bool mask, float yes, float no) { return mask ? yes : no; }
inline std::uint32_t select(bool mask, std::uint32_t yes, std::uint32_t no) { return mask ? yes : no; }

template <class V>
struct Vec3 {
  F<V> x, y, z;
};

template <class V>
Vec3<V> operator+(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class V>
Vec3<V> operator-(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V>
Vec3<V> operator*(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class V>
Vec3<V> operator*(const Vec3<V>& a, const F<V>& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class V>
F<V> dot(const Vec3<V>& a, const Vec3<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class V>
Vec3<V> cross(const Vec3<V>& a, const Vec3<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class V>
F<V> max_channel(const Vec3<V>& a) {
  return max(max(a.x, a.y), a.z);
}
template <class V>
Vec3<V> select(const M<V>& mask, const Vec3<V>& yes, const Vec3<V>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
/// Returns the vector scaled to length 1; a zero vector stays zero.
template <class V>
Vec3<V> unit_vector(const Vec3<V>& a) {
  return a * (1.0F / sqrt(max(dot(a, a), F<V>(1e-30F))));
}

/// The names of N members of a struct, split at compile time from a list such as "p.rays, p.hits".
template <std::size_t N>
struct MemberNames {
  std::array<std::string_view, N> names{};
  consteval MemberNames(std::string_view list) {
    for (std::string_view& name : names) {
      const std::size_t end = std::min(list.find(','), list.size());
      name = list.substr(0, end);
      name.remove_prefix(name.rfind('.') + 1);
      list.remove_prefix(std::min(end + 1, list.size()));
    }
  }
};
/// Calls f(member, name) for each member of a list made by NAMED_ALL.
template <class... Members>
constexpr void name_all(auto&& f, std::type_identity_t<MemberNames<sizeof...(Members)>> list, Members&... members) {
  std::size_t next = 0;
  (f(members, list.names[next++]), ...);
}

}  // namespace kernels

/// Expands to two arguments of name_all(), the text of a list of members and the members: name_all(port,
/// NAMED_ALL(p.rays, p.hits)).
#define NAMED_ALL(...) std::string_view(#__VA_ARGS__), __VA_ARGS__
