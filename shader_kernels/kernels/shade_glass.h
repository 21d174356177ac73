#pragma once
#include <string_view>

#include "shader_kernels/kernels/secondary.h"

namespace kernels {

/// Where reflection is total there is no weight left, hence no ray.
struct ShadeGlass {
  static constexpr std::string_view kName = "shade_glass";
  static constexpr std::string_view kMeaning = "glass surface -> refraction ray";
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
    const F<V> bend = glass.eta * glass.cosine - sqrt(max(glass.inside, F<V>(0.0F)));
    const Vec3<V> refracted = direction * glass.eta + place.normal * bend;
    const F<V> share = optics.entering * (1.0F - glass.reflectance);
    emit_secondary<V>(at, place.position, refracted, {path.throughput * share, path.sample});
  }
};

}  // namespace kernels
