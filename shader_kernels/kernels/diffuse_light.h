#pragma once
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/records.h"

namespace kernels {

/// Light that a surface scatters if nothing is in the way. A spot's edge falls off as in glTF's KHR_lights_punctual,
/// and so does a light with a range.
template <class V>
struct DiffuseLight {
  Vec3<V> to_light;  ///< not of unit length: t = 1 is the light
  F<V> inverse_distance;
  Vec3<V> light;  ///< that the path brings; none of its channels is above 0 if the surface is turned away
};
template <class V>
DiffuseLight<V> diffuse_light(const SurfacePointRecord<V>& point, const PathRecord<V>& path, const Vec3<V>& diffuse,
                              const LightUniforms<V>& light) {
  const Vec3<V> to_light = light.position - point.position * light.local;
  const F<V> squared = dot(to_light, to_light);
  const F<V> inverse_distance = 1.0F / sqrt(squared);
  const F<V> cosine = dot(point.normal, to_light) * inverse_distance;
  const F<V> off_axis = -dot(light.direction, to_light) * inverse_distance;
  const F<V> cone = min(max(off_axis * light.cone_scale + light.cone_offset, F<V>(0.0F)), F<V>(1.0F));
  const F<V> of_range = squared * light.inverse_range_squared;
  const F<V> window = max(1.0F - of_range * of_range, F<V>(0.0F));
  const F<V> share = cosine * (inverse_distance * inverse_distance) * (cone * cone) * window;
  return {to_light, inverse_distance, path.throughput * diffuse * (light.intensity * share)};
}

}  // namespace kernels
