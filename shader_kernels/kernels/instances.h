#pragma once
#include <type_traits>

#include "shader_kernels/ports.h"
#include "traces/ray.h"

namespace kernels {

// Kernels that need more of a hit than which triangle it is come twice: `kInstanced` for scenes of instances (two
// levels), where a hit names its instance and what lies in memory is in the mesh's own space.

template <class V, bool kInstanced>
using Hits = std::conditional_t<kInstanced, Local<V, InstanceHitRecord>, Local<V, HitRecord>>;

template <class V>
HitRecord<V> plain(const HitRecord<V>& hit) {
  return hit;
}
template <class V>
HitRecord<V> plain(const InstanceHitRecord<V>& hit) {
  constexpr float kStep = 1.0F / static_cast<float>(traces::kWeightOne);
  const auto weight = [](const I<V>& word) { return to_float(word >> traces::kHalfBits) * kStep; };
  return {hit.t, weight(hit.u), weight(hit.v), hit.triangle};
}

template <class V>
I<V> triangle_of(const auto& hit) {
  return hit.triangle & traces::kTriangleMask;
}
template <class V>
I<V> instance_of(const InstanceHitRecord<V>& hit) {
  return (hit.u & traces::kHalfMask) | ((hit.v & traces::kHalfMask) << traces::kHalfBits);
}

/// A normal of the mesh in world space, not of unit length: the rows of the matrix that carries points the other way,
/// weighted, are the product with its transpose.
template <class V>
Vec3<V> normal_to_world(const InstanceFields<V>& instance, const Vec3<V>& n) {
  return instance.row0 * n.x + instance.row1 * n.y + instance.row2 * n.z;
}

/// Texture density in world space, given the mesh's normal `n`, as long as the density in the mesh's space, and the
/// length of normal_to_world(n). Areas across n grow by volume * |normal_to_world(n)| / |n|, densities by its root.
template <class V>
F<V> density_in_world(const InstanceFields<V>& instance, const Vec3<V>& n, const F<V>& length_in_world) {
  const F<V> squared = dot(n, n);
  return sqrt(squared * sqrt(squared) / (instance.volume * length_in_world));
}

/// A direction in the surface, unit, or zero if it is. The inverse matrix's columns are the cross products of rows over
/// the determinant, of which only the sign matters.
template <class V>
Vec3<V> tangent_to_world(const InstanceFields<V>& instance, const Vec3<V>& t) {
  const Vec3<V> along = cross(instance.row1, instance.row2) * t.x + cross(instance.row2, instance.row0) * t.y +
                        cross(instance.row0, instance.row1) * t.z;
  return normalised(along) * instance.handedness;
}

}  // namespace kernels
