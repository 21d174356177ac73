#pragma once
#include <limits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// What the executors that send a path on are wired to; `stream` is the one that they work on.
template <class V>
struct SecondaryPorts {
  Local<V, WordRecord> stream;
  Local<V, PlaceRecord> places;
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, OpticsRecord> optics;
  Local<V, RayRecord> next_rays;
  Local<V, PathRecord> next_paths;
  Counter<V> emitted;
  F<V> epsilon, min_weight;
  static void describe(auto& p, auto&& port) {
    port(p.stream, "stream");
    port(p.places, "places");
    port(p.rays, "rays");
    port(p.paths, "paths");
    port(p.optics, "optics");
    port(p.next_rays, "next_rays");
    port(p.next_paths, "next_paths");
    port(p.emitted, "emitted");
    port(p.epsilon, "epsilon");
    port(p.min_weight, "min_weight");
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
