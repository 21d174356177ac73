#pragma once
#include <string_view>

#include "shader_kernels/kernels/classify_layers.h"
#include "sim/named.h"

namespace kernels {

/// Ends a round of going on, and is the inspector of the next.
struct ScatterLayers {
  static constexpr std::string_view kName = "scatter_layers";
  static constexpr std::string_view kMeaning = "continuing ray -> its hit into the slot of the ray that it continues";
  template <class V>
  struct Ports {
    Local<V, WordRecord> targets;
    Local<V, HitRecord> layer_hits;
    Local<V, HitRecord> hits;
    Local<V, WordRecord> layers;
    Counter<V> layer_count;
    I<V> solid;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.targets));
      port(NAMED(p.layer_hits));
      port(NAMED(p.hits));
      port(NAMED(p.layers));
      port(NAMED(p.layer_count));
      port(NAMED(p.solid));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.targets.load(item).word;
    const HitRecord<V> hit = at.layer_hits.load(item);
    at.hits.store(slot, hit);
    at.layers.store(at.layer_count.next(needs_test<V>(hit.triangle, at.solid)), {slot});
  }
};

}  // namespace kernels
