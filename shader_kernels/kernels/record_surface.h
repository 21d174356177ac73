#pragma once
#include <string_view>

#include "shader_kernels/kernels/record_geometry.h"

namespace kernels {

/// As record_geometry, with all that interpolation and shading after it need. The triangle's own normal is turned to
/// the side of the shading normal.
struct RecordSurface {
  static constexpr std::string_view kName = "record_surface";
  static constexpr std::string_view kMeaning = "first hit -> its sample's geometry and surface";
  template <class V>
  struct Ports : RecordGeometry::Ports<V> {
    Local<V, TexcoordRecord> texcoords;
    Local<V, SurfaceRecord> kept;
    static void describe(auto& p, auto&& port) {
      RecordGeometry::Ports<V>::describe(p, port);
      port(p.texcoords, "texcoords");
      port(p.kept, "kept");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const PlaceRecord<V> place = at.places.load(slot);
    const MatteRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> texcoord = at.texcoords.load(slot);
    const TriangleFields<V> t = at.triangles.load(at.hits.load(slot).triangle & traces::kTriangleMask);
    const Vec3<V> across = cross(t.v1 - t.v0, t.v2 - t.v0);
    const F<V> side = select(dot(across, place.normal) <= 0.0F, F<V>(-1.0F), F<V>(1.0F));
    const I<V> sample = at.paths.load(slot).sample;
    at.geometry.store(sample, {place.normal, object_of<V>(t, matte.classes), place.position, 0U});
    at.kept.store(sample,
                  {matte.diffuse, matte.classes, normalised(across) * side, texcoord.u, texcoord.v, texcoord.texture});
  }
};

}  // namespace kernels
