#pragma once
#include <string_view>

#include "shader_kernels/kernels/instances.h"
#include "shader_kernels/kernels/vertex_colour.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

template <bool kInstanced>
struct FetchVertices {
  static constexpr std::string_view kName = kInstanced ? "fetch_vertices_instanced" : "fetch_vertices";
  static constexpr std::string_view kMeaning =
      kInstanced ? "as fetch_vertices, with the tangent out of the mesh's space"
                 : "surface -> tangent, second texture coordinates; times vertex colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> vertexed;
    Hits<V, kInstanced> hits;
    Local<V, DiffuseRecord> mattes;
    Local<V, SpecularRecord> optics;
    Local<V, TangentRecord> tangents;
    Vertices<V> vertices;
    Instances<V> instances;  ///< wired if kInstanced
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.vertexed));
      port(NAMED(p.hits));
      port(NAMED(p.mattes));
      port(NAMED(p.optics));
      port(NAMED(p.tangents));
      port(NAMED(p.vertices));
      if constexpr (kInstanced) port(NAMED(p.instances));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.vertexed.load(item).word;
    const auto found = at.hits.load(slot);
    const HitRecord<V> hit = plain<V>(found);
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    SpecularRecord<V> optics = at.optics.load(slot);
    const VertexFields<V> vertex = at.vertices.load(triangle_of<V>(hit));
    const Weights<V> corners(hit);
    const VertexColour<V> colour = vertex_colour<V>(corners, vertex);
    at.mattes.store(slot, {matte.diffuse * colour.rgb, matte.classes});
    optics.tint = optics.tint * colour.rgb;
    optics.alpha = optics.alpha * colour.alpha;
    at.optics.store(slot, optics);
    const auto signed_byte = [&](std::uint32_t byte) {
      const auto part = [&](const I<V>& word) { return byte_of<V>(word, byte); };
      return (corners.interpolate_int(part(vertex.tangent0), part(vertex.tangent1), part(vertex.tangent2)) - 128.0F) *
             (1.0F / 127.0F);
    };
    Vec3<V> tangent{signed_byte(0), signed_byte(1), signed_byte(2)};
    F<V> handedness = signed_byte(3);
    if constexpr (kInstanced) {
      const InstanceFields<V> instance = at.instances.load(instance_of<V>(found));
      tangent = tangent_to_world<V>(instance, tangent);
      handedness = handedness * instance.handedness;
    }
    at.tangents.store(slot, {tangent, handedness, corners.interpolate(vertex.u0, vertex.u1, vertex.u2),
                             corners.interpolate(vertex.v0, vertex.v1, vertex.v2)});
  }
};

}  // namespace kernels
