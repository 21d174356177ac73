#pragma once
#include <string_view>

#include "shader_kernels/kernels/secondary.h"

namespace kernels {

struct ShadeStraight {
  static constexpr std::string_view kName = "shade_straight";
  static constexpr std::string_view kMeaning = "blended surface -> refraction ray that goes straight on";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const Vec3<V> position = at.points.load(slot).position;
    const Vec3<V> direction = at.rays.load(slot).direction;
    const PathRecord<V> path = at.paths.load(slot);
    const F<V> share = 1.0F - at.optics.load(slot).alpha;
    emit_secondary<V>(at, position, direction, {path.throughput * share, path.sample});
  }
};

}  // namespace kernels
