#pragma once
#include <string_view>

#include "shader_kernels/kernels/layers.h"

namespace kernels {

/// For rays that want the nearest hit. Where a mask's alpha is below its cutoff there is no surface, and neither is
/// where a blended one's alpha is too little to be seen.
template <bool kColoured, bool kInstanced>
struct TestAlpha {
  static constexpr std::string_view kName = kInstanced
                                                ? (kColoured ? "test_alpha_coloured_instanced" : "test_alpha_instanced")
                                                : (kColoured ? "test_alpha_coloured" : "test_alpha");
  static constexpr std::string_view kMeaning =
      kColoured ? "as test_alpha, with vertex colours"
                : (kInstanced ? "as test_alpha, of instances"
                              : "hit on a surface with alpha -> continuing ray, if it is a hole");
  template <class V>
  using Ports = LayerPorts<V, kColoured, kInstanced>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.layers.load(item).word;
    const RayRecord<V> ray = at.rays.load(slot);
    const HitRecord<V> hit = plain<V>(at.hits.load(slot));
    const Layer<V> layer = fetch_layer<V, kColoured, kInstanced>(at, hit);
    const M<V> is_blended = has<V>(layer.material.flags, traces::kBlended);
    const F<V> least = select(is_blended, at.min_weight, layer.material.alpha_cutoff);
    go_on<V, kColoured, kInstanced>(at, layer.alpha < least, slot, ray, hit.t);
  }
};

}  // namespace kernels
