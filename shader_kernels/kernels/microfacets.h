#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/value.h"
#include "traces/accel/memory_image.h"

namespace kernels {

// Reflection by GGX microfacets: Smith's height-correlated masking (Heitz 2014), Schlick's Fresnel term, and visible
// normals by spherical caps (Dupuy & Benyoub 2023). Only single scattering: rough metals lose some light.

/// Lower bound of the cosine between a rough surface's normal and a direction; smaller cosines are raised to it.
inline constexpr float kGrazing = 1e-3F;

/// Returns sin(half_turns * pi) for half_turns in [-1/2, 1/2], from its series; the error is below 4e-6.
template <class V>
F<V> sine_of_half_turns(const F<V>& half_turns) {
  const F<V> square = half_turns * half_turns;
  const F<V> series = ((square * 0.0821459F - 0.5992645F) * square + 2.5501640F) * square - 5.1677128F;
  return half_turns * (series * square + 3.1415927F);
}

/// Returns the point of a circle around the origin at angle `turn`, 0 to 1.
template <class V>
UnitPoint<V> circle_point(const F<V>& turn, const F<V>& radius) {
  const F<V> half_turns = turn * 2.0F - 1.0F;
  const F<V> size = abs(half_turns);
  const F<V> sine = sine_of_half_turns<V>(min(size, 1.0F - size));
  return {radius * sine_of_half_turns<V>(0.5F - size), radius * select(half_turns < 0.0F, -sine, sine)};
}

/// Returns the GGX parameter alpha, the square of the roughness in a surface's classes.
template <class V>
F<V> alpha_of(const I<V>& classes) {
  const F<V> roughness = to_float(classes >> traces::kRoughnessShift) * (1.0F / 255.0F);
  return roughness * roughness;
}

/// Returns how far Schlick's reflectance is on the way from normal incidence to 1, 0 to 1.
template <class V>
F<V> schlick_share(const F<V>& cosine) {
  const F<V> away = max(1.0F - cosine, F<V>(0.0F));
  const F<V> squared = away * away;
  return squared * squared * away;
}

/// Returns the reflectance at an angle. `mirrored`: reflectance at normal incidence; `most`: reflectance at grazing
/// incidence.
template <class V>
Vec3<V> schlick_reflectance(const Vec3<V>& mirrored, const F<V>& most, const F<V>& cosine) {
  return mirrored + (Vec3<V>{most, most, most} - mirrored) * schlick_share<V>(cosine);
}

/// Returns Smith's Lambda of a direction: microfacets that others hide, per visible one.
template <class V>
F<V> hidden_facets(const F<V>& cosine, const F<V>& alpha) {
  return sqrt(alpha * alpha * (1.0F / (cosine * cosine) - 1.0F) + 1.0F) * 0.5F - 0.5F;
}

/// Returns the fraction of light, times pi, that microfacets scatter from a light source to the eye: pi times the BRDF.
/// `direction` is that of the ray, and `to_light` a unit vector. `from_eye` and `from_light` are the cosines of both
/// with the normal.
template <class V>
Vec3<V> scatter_by_facets(const Vec3<V>& direction, const Vec3<V>& to_light, const Vec3<V>& normal,
                          const F<V>& from_eye, const F<V>& from_light, const Vec3<V>& mirrored, const F<V>& most,
                          const F<V>& alpha) {
  const Vec3<V> facet = unit_vector(to_light - direction);
  const F<V> upright = dot(normal, facet), squared = alpha * alpha;
  const F<V> spread = upright * upright * (squared - 1.0F) + 1.0F;
  const F<V> lit = max(from_light, F<V>(kGrazing));
  const F<V> seen = hidden_facets<V>(from_eye, alpha) + hidden_facets<V>(lit, alpha) + 1.0F;
  const F<V> share = squared / (spread * spread * (seen * (from_eye * lit * 4.0F)));
  return schlick_reflectance<V>(mirrored, most, -dot(direction, facet)) * share;
}

/// A direction into which a microfacet reflects a ray, and the weight of its light. The weight is 0 if the direction
/// points into the surface, and never above the reflectance.
template <class V>
struct FacetReflection {
  Vec3<V> direction, weight;
};
/// Reflects a ray by a random microfacet among those that it sees. `square`: random numbers that choose the microfacet.
template <class V>
FacetReflection<V> reflect_by_facet(const Vec3<V>& direction, const Vec3<V>& normal, const UnitPoint<V>& square,
                                    const Vec3<V>& mirrored, const F<V>& most, const F<V>& alpha) {
  const PerpendicularAxes<V> axes = perpendicular_axes<V>(normal);
  const Vec3<V> eye{-dot(direction, axes.x), -dot(direction, axes.y), max(-dot(direction, normal), F<V>(kGrazing))};
  // A random point of the cap of a sphere, added to the stretched view, is a visible normal of a hemisphere.
  const Vec3<V> view = unit_vector(Vec3<V>{eye.x * alpha, eye.y * alpha, eye.z});
  const F<V> height = (1.0F - square.y) * (view.z + 1.0F) - view.z;
  const UnitPoint<V> around = circle_point<V>(square.x, sqrt(max(1.0F - height * height, F<V>(0.0F))));
  const Vec3<V> facet =
      unit_vector(Vec3<V>{(around.x + view.x) * alpha, (around.y + view.y) * alpha, max(height + view.z, F<V>(0.0F))});
  const F<V> cosine = dot(eye, facet);
  const Vec3<V> out = facet * (cosine * 2.0F) - eye;
  const F<V> hidden = hidden_facets<V>(eye.z, alpha) + 1.0F;
  const F<V> seen = hidden / (hidden + hidden_facets<V>(max(out.z, F<V>(kGrazing)), alpha));
  const Vec3<V> weight = schlick_reflectance<V>(mirrored, most, cosine) * select(F<V>(0.0F) < out.z, seen, F<V>(0.0F));
  return {unit_vector(axes.x * out.x + axes.y * out.y + normal * out.z), weight};
}

}  // namespace kernels
