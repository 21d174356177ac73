#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// True if a hit carries a flag that asks for a test: `solid` is the largest triangle word that does not.
template <class V>
M<V> needs_test(const I<V>& triangle, const I<V>& solid) {
  return both(solid < triangle, triangle < traces::kNoHit);
}

/// The inspector of hits: those at which the ray may have to go on.
struct ClassifyLayers {
  static constexpr std::string_view kName = "classify_layers";
  static constexpr std::string_view kMeaning = "ray slot -> stream of hits that a texture or a tint decides about";
  template <class V>
  struct Ports {
    Local<V, HitRecord> hits;
    Local<V, WordRecord> layers;
    Counter<V> layer_count;
    I<V> solid;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.hits));
      port(NAMED(p.layers));
      port(NAMED(p.layer_count));
      port(NAMED(p.solid));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> triangle = at.hits.load(item).triangle;
    at.layers.store(at.layer_count.next(needs_test<V>(triangle, at.solid)), {item});
  }
};

}  // namespace kernels
