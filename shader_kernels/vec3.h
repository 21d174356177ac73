#pragma once
#include "shader_kernels/value.h"

namespace kernels {

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
F<V> largest(const Vec3<V>& a) {
  return max(max(a.x, a.y), a.z);
}
template <class V>
Vec3<V> select(const M<V>& mask, const Vec3<V>& yes, const Vec3<V>& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}
/// Returns the unit vector; a zero vector stays zero.
template <class V>
Vec3<V> normalised(const Vec3<V>& a) {
  return a * (1.0F / sqrt(max(dot(a, a), F<V>(1e-30F))));
}

}  // namespace kernels
