#pragma once
#include <string_view>

#include "shader_kernels/kernels/record_first_hit.h"
#include "sim/named.h"

namespace kernels {

/// Across a triangle's plane.
template <class V>
Vec3<V> across_of(const TriangleFields<V>& t) {
  return cross(t.v1 - t.v0, t.v2 - t.v0);
}

/// As record_geometry, with all that interpolation and shading after it need. The triangle's own normal is turned to
/// the side of the shading normal.
template <bool kInstanced>
struct RecordSurface {
  static constexpr std::string_view kName = kInstanced ? "record_surface_instanced" : "record_surface";
  static constexpr std::string_view kMeaning =
      kInstanced ? "as record_surface, of an instance" : "first hit -> its sample's geometry and surface";
  template <class V>
  struct Ports : RecordGeometry<kInstanced>::template Ports<V> {
    Triangles<V> corners;  ///< wired if kInstanced; otherwise the objects are triangles
    Local<V, TexcoordRecord> texcoords;
    Local<V, SurfaceRecord> kept;
    static void describe(auto& p, auto&& port) {
      RecordGeometry<kInstanced>::template Ports<V>::describe(p, port);
      if constexpr (kInstanced) port(p.corners, "triangles");
      port(NAMED(p.texcoords));
      port(NAMED(p.kept));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const SurfacePointRecord<V> point = at.points.load(slot);
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> texcoord = at.texcoords.load(slot);
    const auto hit = at.hits.load(slot);
    const auto found = at.objects.load(index_of<V>(hit));
    Vec3<V> across;
    if constexpr (kInstanced) {
      across = normal_to_world<V>(found, across_of<V>(at.corners.load(triangle_of<V>(hit))));
    } else {
      across = across_of<V>(found);
    }
    const F<V> side = select(dot(across, point.normal) <= 0.0F, F<V>(-1.0F), F<V>(1.0F));
    const I<V> sample = at.paths.load(slot).sample;
    at.geometry.store(sample, {point.normal, marked<V>(found.object, matte.classes), point.position, 0U});
    at.kept.store(sample, {matte.diffuse, matte.classes, normalised(across) * side, texcoord.u, texcoord.v,
                           texcoord.texture, point.material});
  }
};

}  // namespace kernels
