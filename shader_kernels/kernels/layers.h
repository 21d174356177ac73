#pragma once
#include "shader_kernels/kernels/instances.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/vertex_colour.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Ports of tests of flagged hits. A ray that goes on is the ray of its slot, seen from just behind the hit.
/// `kColoured`: the scene has vertex records, whose colours and second texture coordinates have a say.
template <class V, bool kColoured, bool kInstanced>
struct LayerPorts {
  Local<V, WordRecord> layers;
  Local<V, RayRecord> rays;
  Hits<V, kInstanced> hits;
  Attributes<V> attributes;
  Materials<V> materials;
  Vertices<V> vertices;  ///< wired if kColoured
  Table<V, AxisRecord> axes;
  Texels<V> texels;
  Local<V, RayRecord> next_rays;
  Local<V, WordRecord> targets;  ///< slots of the rays that go on
  Counter<V> emitted;
  F<V> epsilon, min_weight;  ///< lower ones are not seen
  I<V> white;                ///< the texture of materials without one
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.layers));
    port(NAMED(p.rays));
    port(NAMED(p.hits));
    port(NAMED(p.attributes));
    port(NAMED(p.materials));
    if constexpr (kColoured) port(NAMED(p.vertices));
    port(NAMED(p.axes));
    port(NAMED(p.texels));
    port(NAMED(p.next_rays));
    port(NAMED(p.targets));
    port(NAMED(p.emitted));
    port(NAMED(p.epsilon));
    port(NAMED(p.min_weight));
    port(NAMED(p.white));
  }
};

/// Surface at a flagged hit.
template <class V>
struct Layer {
  MaterialFields<V> material;
  Sample<V> base;
  VertexColour<V> colour;  ///< set if kColoured
  F<V> alpha;
};

template <class V, bool kColoured, bool kInstanced>
Layer<V> fetch_layer(const LayerPorts<V, kColoured, kInstanced>& at, const HitRecord<V>& hit) {
  const I<V> triangle = triangle_of<V>(hit);
  const AttributeFields<V> a = at.attributes.load(triangle);
  const MaterialFields<V> m = at.materials.load(a.material);
  const Weights<V> corners(hit);
  F<V> u = corners.interpolate(a.u0, a.u1, a.u2);
  F<V> v = corners.interpolate(a.v0, a.v1, a.v2);
  F<V> alpha = m.opacity;
  VertexColour<V> colour{};
  if constexpr (kColoured) {
    const VertexFields<V> vertex = at.vertices.load(triangle);
    const M<V> second = has<V>(m.flags, traces::kBaseSecond);
    u = select(second, corners.interpolate(vertex.u0, vertex.u1, vertex.u2), u);
    v = select(second, corners.interpolate(vertex.v0, vertex.v1, vertex.v2), v);
    colour = vertex_colour<V>(corners, vertex);
    alpha = alpha * colour.alpha;
  }
  const I<V> texture = select(m.base_texture < traces::kNoTexture, m.base_texture, at.white);
  const Sample<V> base = sample<V>(at.axes, at.texels, texture, u, v);
  return {m, base, colour, alpha * base.linear(3)};
}

/// Sends the ray of a slot on if told to: from a little more than rounding behind its hit, so that whatever lies at the
/// same distance is passed with it.
template <class V, bool kColoured, bool kInstanced>
void go_on(LayerPorts<V, kColoured, kInstanced>& at, const M<V>& onwards, const I<V>& slot, const RayRecord<V>& ray,
           const F<V>& t) {
  const I<V> out = at.emitted.next(onwards);
  const F<V> step = at.epsilon * 0x1p-6F / sqrt(dot(ray.direction, ray.direction));
  at.next_rays.store(out, {ray.origin, t + (t * 0x1p-17F + step), ray.direction, ray.t_max});
  at.targets.store(out, {slot});
}

}  // namespace kernels
