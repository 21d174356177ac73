#pragma once
#include <string_view>

#include "shader_kernels/kernels/layers.h"
#include "sim/named.h"

namespace kernels {

template <class V, bool kColoured, bool kInstanced>
struct ShadowLayerPorts : LayerPorts<V, kColoured, kInstanced> {
  Local<V, PathRecord> paths;
  Table<V, SrgbCodeRecord> srgb_codes;
  static void describe(auto& p, auto&& port) {
    LayerPorts<V, kColoured, kInstanced>::describe(p, port);
    port(NAMED(p.paths));
    port(NAMED(p.srgb_codes));
  }
};

/// For shadow rays: how much light passes, and whether that is enough to go on. A mask blocks or lets pass, a blended
/// surface lets 1 - alpha pass, and what glass covers is tinted by its transmission and base colour: neither bent nor
/// mirrored, which would take the light away from the point that asks for it.
template <bool kColoured, bool kInstanced>
struct TestShadow {
  static constexpr std::string_view kName =
      kInstanced ? (kColoured ? "test_shadow_coloured_instanced" : "test_shadow_instanced")
                 : (kColoured ? "test_shadow_coloured" : "test_shadow");
  static constexpr std::string_view kMeaning =
      kColoured ? "as test_shadow, with vertex colours"
                : (kInstanced ? "as test_shadow, of instances"
                              : "shadow ray's hit on what is not solid -> continuing ray, dimmed");
  template <class V>
  using Ports = ShadowLayerPorts<V, kColoured, kInstanced>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.layers.load(item).word;
    const RayRecord<V> ray = at.rays.load(slot);
    const HitRecord<V> hit = plain<V>(at.hits.load(slot));
    const PathRecord<V> path = at.paths.load(slot);
    const Layer<V> layer = fetch_layer<V, kColoured, kInstanced>(at, hit);
    const MaterialFields<V>& m = layer.material;
    const F<V> solid = select(layer.alpha < m.alpha_cutoff, F<V>(0.0F), F<V>(1.0F));
    const F<V> cover = select(has<V>(m.flags, traces::kBlended), layer.alpha, solid);
    Vec3<V> colour = m.base_colour * layer.base.colour(at.srgb_codes);
    if constexpr (kColoured) colour = colour * layer.colour.rgb;
    const F<V> open = 1.0F - cover;
    const Vec3<V> light = path.throughput * (colour * (cover * m.entering) + Vec3<V>{open, open, open});
    at.paths.store(slot, {light, path.sample});
    go_on<V, kColoured, kInstanced>(at, at.min_weight < largest(light), slot, ray, hit.t);
  }
};

}  // namespace kernels
