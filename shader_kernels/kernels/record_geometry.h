#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// What says of a surface that its colour comes from a texture.
inline constexpr std::uint32_t kAnyTexture =
    traces::kTextured | traces::kBased | traces::kPhysical | traces::kBumped | traces::kGlowing;

/// A hit's object with the flag of a textured one.
template <class V>
I<V> object_of(const TriangleFields<V>& triangle, const I<V>& classes) {
  return triangle.object | select(I<V>(0U) < (classes & kAnyTexture), I<V>(kTexturedObject), I<V>(0U));
}

/// The object of a hit stands in its triangle's record, which the intersection unit has just read.
struct RecordGeometry {
  static constexpr std::string_view kName = "record_geometry";
  static constexpr std::string_view kMeaning = "first hit -> its sample's geometry: object, normal, position";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, HitRecord> hits;
    Local<V, PlaceRecord> places;
    Local<V, MatteRecord> mattes;
    Local<V, PathRecord> paths;
    Triangles<V> triangles;
    Local<V, GeometryRecord> geometry;
    static void describe(auto& p, auto&& port) {
      port(p.surfaces, "surfaces");
      port(p.hits, "hits");
      port(p.places, "places");
      port(p.mattes, "mattes");
      port(p.paths, "paths");
      port(p.triangles, "triangles");
      port(p.geometry, "geometry");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const PlaceRecord<V> place = at.places.load(slot);
    const TriangleFields<V> triangle = at.triangles.load(at.hits.load(slot).triangle & traces::kTriangleMask);
    at.geometry.store(at.paths.load(slot).sample,
                      {place.normal, object_of<V>(triangle, at.mattes.load(slot).classes), place.position, 0U});
  }
};

}  // namespace kernels
