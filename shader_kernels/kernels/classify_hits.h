#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// The first inspector: one stream of slots for the rays that left the scene, one for those that hit something.
struct ClassifyHits {
  static constexpr std::string_view kName = "classify_hits";
  static constexpr std::string_view kMeaning = "ray slot -> stream of misses or stream of hits";
  template <class V>
  struct Ports {
    Local<V, HitRecord> hits;
    Local<V, WordRecord> misses, surfaces;
    Counter<V> miss_count, surface_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.hits));
      port(NAMED(p.misses));
      port(NAMED(p.surfaces));
      port(NAMED(p.miss_count));
      port(NAMED(p.surface_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> triangle = at.hits.load(item).triangle;
    at.misses.store(at.miss_count.next(triangle == traces::kNoHit), {item});
    at.surfaces.store(at.surface_count.next(triangle < traces::kNoHit), {item});
  }
};

}  // namespace kernels
