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
    const auto [point, direction, path, optics, glass] = specular_hit<V>(item, at);
    const F<V> share = optics.entering * glass.reflectance;
    const Vec3<V> tint = optics.mirrored + Vec3<V>{share, share, share};
    const Vec3<V> reflected = direction + point.normal * (2.0F * glass.cosine);
    emit_secondary<V>(at, point.position, reflected, {path.throughput * tint, path.sample});
  }
};

}  // namespace kernels
