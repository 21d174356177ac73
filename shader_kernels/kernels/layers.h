#pragma once
#include <string_view>

#include "shader_kernels/kernels/classify.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/shade_surface.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Ports of kernels that test possibly transparent hits. If a ray passes, a new ray begins just after the hit.
/// kColoured: the scene has vertex records with colours and second texture coordinates.
template <class V, bool kColoured, bool kInstanced>
struct LayerPorts {
  Local<V, WordRecord> layers;
  Local<V, RayRecord> rays;
  Hits<V, kInstanced> hits;
  Attributes<V> attributes;
  Materials<V> materials;
  Vertices<V> vertices;  ///< vertex records; only in kColoured variants
  Table<V, AxisRecord> axes;
  Texels<V> texels;
  Local<V, RayRecord> next_rays;
  Local<V, WordRecord> targets;  ///< ray slots that receive the hits of the continuing rays
  Counter<V> emitted;
  F<V> epsilon, min_weight;  ///< a path ends if its weight is below min_weight
  I<V> white;                ///< number of the white texture that is read if a material has no base texture
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.layers, p.rays, p.hits, p.attributes, p.materials));
    if constexpr (kColoured) port(NAMED(p.vertices));
    name_all(port, NAMED_ALL(p.axes, p.texels, p.next_rays, p.targets, p.emitted, p.epsilon, p.min_weight, p.white));
  }
};

/// The surface at a possibly transparent hit.
template <class V>
struct Layer {
  MaterialFields<V> material;
  TexelSample<V> base;
  VertexColour<V> colour;  ///< interpolated vertex colour; only in kColoured variants
  F<V> alpha;
};

template <class V, bool kColoured, bool kInstanced>
Layer<V> fetch_layer(const LayerPorts<V, kColoured, kInstanced>& io, const HitRecord<V>& hit) {
  const I<V> triangle = triangle_index_of<V>(hit);
  const AttributeFields<V> a = io.attributes.load(triangle);
  const MaterialFields<V> m = io.materials.load(a.material);
  const Weights<V> corners(hit);
  F<V> u = corners.interpolate(a.u0, a.u1, a.u2);
  F<V> v = corners.interpolate(a.v0, a.v1, a.v2);
  F<V> alpha = m.opacity;
  VertexColour<V> colour{};
  if constexpr (kColoured) {
    const VertexFields<V> vertex = io.vertices.load(triangle);
    const M<V> second = has_flag<V>(m.flags, traces::kBaseSecond);
    u = select(second, corners.interpolate(vertex.u0, vertex.u1, vertex.u2), u);
    v = select(second, corners.interpolate(vertex.v0, vertex.v1, vertex.v2), v);
    colour = vertex_colour<V>(corners, vertex);
    alpha = alpha * colour.alpha;
  }
  const I<V> texture = select(m.base_texture < traces::kNoTexture, m.base_texture, io.white);
  const TexelSample<V> base = sample_texture<V>(io.axes, io.texels, texture, u, v);
  return {m, base, colour, alpha * base.linear_channel(3)};
}

/// Emits a ray that continues the ray of `slot` after its hit at distance `t`, if `onwards` is true. The new ray begins
/// slightly more than a rounding error after the hit, so that it also passes other surfaces at the same distance.
template <class V, bool kColoured, bool kInstanced>
void continue_ray(LayerPorts<V, kColoured, kInstanced>& io, const M<V>& onwards, const I<V>& slot,
                  const RayRecord<V>& ray, const F<V>& t) {
  const I<V> out = io.emitted.next_index(onwards);
  const F<V> step = io.epsilon * 0x1p-6F / sqrt(dot(ray.direction, ray.direction));
  io.next_rays.store(out, {ray.origin, t + (t * 0x1p-17F + step), ray.direction, ray.t_max});
  io.targets.store(out, {slot});
}

/// Tests whether a nearest-hit ray passes a transparent surface: the alpha of an alpha-masked surface is below its
/// cutoff, or the alpha of a blended surface is too small to be visible.
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
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.layers.load(item).word;
    const RayRecord<V> ray = io.rays.load(slot);
    const HitRecord<V> hit = decode_hit_weights<V>(io.hits.load(slot));
    const Layer<V> layer = fetch_layer<V, kColoured, kInstanced>(io, hit);
    const M<V> is_blended = has_flag<V>(layer.material.flags, traces::kBlended);
    const F<V> least = select(is_blended, io.min_weight, layer.material.alpha_cutoff);
    continue_ray<V, kColoured, kInstanced>(io, layer.alpha < least, slot, ray, hit.t);
  }
};

template <class V, bool kColoured, bool kInstanced>
struct ShadowLayerPorts : LayerPorts<V, kColoured, kInstanced> {
  Local<V, PathRecord> paths;
  Table<V, SrgbCodeRecord> srgb_codes;
  static constexpr void describe(auto& p, auto&& port) {
    LayerPorts<V, kColoured, kInstanced>::describe(p, port);
    name_all(port, NAMED_ALL(p.paths, p.srgb_codes));
  }
};

/// Tests how much light of a shadow ray passes a transparent surface, and continues the ray if enough does. An
/// alpha-masked surface passes all or nothing. A blended surface passes 1 - alpha. Glass multiplies the light by its
/// transmission and base colour. Refraction is ignored, because a bent ray would miss the light source.
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
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.layers.load(item).word;
    const RayRecord<V> ray = io.rays.load(slot);
    const HitRecord<V> hit = decode_hit_weights<V>(io.hits.load(slot));
    const PathRecord<V> path = io.paths.load(slot);
    const Layer<V> layer = fetch_layer<V, kColoured, kInstanced>(io, hit);
    const MaterialFields<V>& m = layer.material;
    const F<V> solid = select(layer.alpha < m.alpha_cutoff, F<V>(0.0F), F<V>(1.0F));
    const F<V> cover = select(has_flag<V>(m.flags, traces::kBlended), layer.alpha, solid);
    Vec3<V> colour = m.base_colour * layer.base.srgb_colour(io.srgb_codes);
    if constexpr (kColoured) colour = colour * layer.colour.rgb;
    const F<V> open = 1.0F - cover;
    const Vec3<V> light = path.throughput * (colour * (cover * m.entering) + Vec3<V>{open, open, open});
    io.paths.store(slot, {light, path.sample});
    continue_ray<V, kColoured, kInstanced>(io, io.min_weight < max_channel(light), slot, ray, hit.t);
  }
};

/// Stores the hits of rays that continued after a transparent surface in the slots of the original rays. Lists those
/// hits that must be tested for transparency in the next round.
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
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.targets, p.layer_hits, p.hits, p.layers, p.layer_count, p.solid));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.targets.load(item).word;
    const HitRecord<V> hit = io.layer_hits.load(item);
    io.hits.store(slot, hit);
    io.layers.store(io.layer_count.next_index(needs_transparency_test<V>(hit.triangle, io.solid)), {slot});
  }
};

}  // namespace kernels
