#pragma once
#include <string_view>

#include "shader_kernels/kernels/secondary.h"

namespace kernels {

/// Total reflection leaves no weight, hence no ray.
struct ShadeGlass {
  static constexpr std::string_view kName = "shade_glass";
  static constexpr std::string_view kMeaning = "glass surface -> refraction ray";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const auto [point, direction, path, optics, glass] = specular_hit<V>(item, at);
    const F<V> bend = glass.eta * glass.cosine - sqrt(max(glass.inside, F<V>(0.0F)));
    const Vec3<V> refracted = direction * glass.eta + point.normal * bend;
    const F<V> share = optics.entering * (1.0F - glass.reflectance);
    emit_secondary<V>(at, point.position, refracted, {path.throughput * share, path.sample});
  }
};

}  // namespace kernels
