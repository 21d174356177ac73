#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_neighbours.h"
#include "sim/named.h"

namespace kernels {

/// Geometry that an interpolated sample keeps, for checks along the other axis that it is a reference of. Attributes
/// that had to be equal are taken over.
template <class V>
GeometryRecord<V> lerp_geometry(const GeometryRecord<V>& a, const GeometryRecord<V>& b, const F<V>& weight) {
  return {normalised(lerp<V>(a.normal, b.normal, weight)), a.object, lerp<V>(a.position, b.position, weight),
          a.shadows};
}

/// The executor of samples that have passed (Lee et al. 2016): the colour in the middle of two. Along x it also leaves
/// the geometry there, as checks along y look at it.
template <bool kAlongY, bool kSecondary>
struct InterpolateSample {
  static constexpr std::string_view kName =
      kAlongY ? "interpolate_y" : (kSecondary ? "interpolate_x_secondary" : "interpolate_x");
  static constexpr std::string_view kMeaning = "sample that passed -> colour between its references";
  template <class V>
  struct Ports {
    Local<V, WordRecord> passed;
    LineUniforms<V> line;
    Local<V, ColourRecord> colours;
    Local<V, GeometryRecord> geometry;
    Local<V, SecondaryRecord> secondary;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.passed));
      LineUniforms<V>::describe(p.line, port);
      port(NAMED(p.colours));
      port(NAMED(p.geometry));
      port(NAMED(p.secondary));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    interpolate<V>(passed<V>(at.passed.load(item).word, at.line), at);
  }
  template <class V>
  static void interpolate(const Passed<V>& p, const Ports<V>& at) {
    at.colours.store(p.sample,
                     {lerp_colours<V>(at.colours.load(p.before).rgb, at.colours.load(p.after).rgb, p.weight)});
    if constexpr (!kAlongY) {
      at.geometry.store(p.sample, lerp_geometry<V>(at.geometry.load(p.before), at.geometry.load(p.after), p.weight));
    }
    if constexpr (kSecondary) {
      const SecondaryRecord<V> a = at.secondary.load(p.before);
      const SecondaryRecord<V> b = at.secondary.load(p.after);
      at.secondary.store(p.sample, {normalised(lerp<V>(a.mirror_normal, b.mirror_normal, p.weight)), a.objects,
                                    normalised(lerp<V>(a.glass_normal, b.glass_normal, p.weight)), a.shadows});
    }
  }
};

}  // namespace kernels
