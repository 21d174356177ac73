#pragma once
#include <string_view>

#include "shader_kernels/kernels/secondary.h"

namespace kernels {

/// Mirrors and the mirrored share of glass: one ray carries both.
struct ShadeMirror {
  static constexpr std::string_view kName = "shade_mirror";
  static constexpr std::string_view kMeaning = "mirror or glass surface -> reflection ray";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const PlaceRecord<V> place = at.places.load(slot);
    const Vec3<V> direction = at.rays.load(slot).direction;
    const PathRecord<V> path = at.paths.load(slot);
    const SpecularRecord<V> optics = at.optics.load(slot);
    const Interface<V> glass = interface<V>(direction, place.normal, place.side, optics.ior);
    const F<V> share = optics.entering * glass.reflectance;
    const Vec3<V> tint = optics.mirrored + Vec3<V>{share, share, share};
    const Vec3<V> reflected = direction + place.normal * (2.0F * glass.cosine);
    emit_secondary<V>(at, place.position, reflected, {path.throughput * tint, path.sample});
  }
};

}  // namespace kernels
