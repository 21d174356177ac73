#pragma once
#include <limits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Ports of the executors that send a path on; `stream` is the one that they work on.
template <class V>
struct SecondaryPorts {
  Local<V, WordRecord> stream;
  Local<V, SurfacePointRecord> points;
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, SpecularRecord> optics;
  Local<V, RayRecord> next_rays;
  Local<V, PathRecord> next_paths;
  Counter<V> emitted;
  F<V> epsilon, min_weight;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.stream));
    port(p.points, "places");
    port(NAMED(p.rays));
    port(NAMED(p.paths));
    port(NAMED(p.optics));
    port(NAMED(p.next_rays));
    port(NAMED(p.next_paths));
    port(NAMED(p.emitted));
    port(NAMED(p.epsilon));
    port(NAMED(p.min_weight));
  }
};

/// Sends a path on if it still carries enough to be seen.
template <class V>
void emit_secondary(SecondaryPorts<V>& at, const Vec3<V>& origin, const Vec3<V>& direction, const PathRecord<V>& path) {
  const I<V> out = at.emitted.next(at.min_weight < largest(path.throughput));
  at.next_rays.store(out, {origin, at.epsilon, direction, std::numeric_limits<float>::infinity()});
  at.next_paths.store(out, path);
}

}  // namespace kernels
