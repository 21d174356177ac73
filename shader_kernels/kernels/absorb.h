#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Rays that want the nearest hit have directions of unit length, so `t` is the way they have come.
struct Absorb {
  static constexpr std::string_view kName = "absorb";
  static constexpr std::string_view kMeaning = "surface of an absorbing body -> path dimmed if it was met from inside";
  template <class V>
  struct Ports {
    Local<V, WordRecord> absorbing;
    Local<V, SurfacePointRecord> points;
    Local<V, HitRecord> hits;
    Local<V, PathRecord> paths;
    Details<V> details;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.absorbing));
      port(p.points, "places");
      port(NAMED(p.hits));
      port(NAMED(p.paths));
      port(NAMED(p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.absorbing.load(item).word;
    const SurfacePointRecord<V> point = at.points.load(slot);
    const PathRecord<V> path = at.paths.load(slot);
    const F<V> inside = at.hits.load(slot).t * max(-point.side, F<V>(0.0F));
    const Vec3<V> depth = at.details.load(point.material).absorption * inside;
    const Vec3<V> left{decay<V>(depth.x), decay<V>(depth.y), decay<V>(depth.z)};
    at.paths.store(slot, {path.throughput * left, path.sample});
  }
};

}  // namespace kernels
