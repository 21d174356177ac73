#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/instances.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Classes of a surface whose colour comes from a texture.
inline constexpr std::uint32_t kAnyTexture =
    traces::kTextured | traces::kBased | traces::kPhysical | traces::kBumped | traces::kGlowing;

/// The object of a hit stands in its triangle's record, which the intersection unit has just read, or in its
/// instance's.
template <class V, bool kInstanced>
using Objects = std::conditional_t<kInstanced, Instances<V>, Triangles<V>>;

/// Index of that record.
template <class V>
I<V> index_of(const HitRecord<V>& hit) {
  return triangle_of<V>(hit);
}
template <class V>
I<V> index_of(const InstanceHitRecord<V>& hit) {
  return instance_of<V>(hit);
}

/// An object with the flag of a textured one.
template <class V>
I<V> marked(const I<V>& object, const I<V>& classes) {
  return object | select(I<V>(0U) < (classes & kAnyTexture), I<V>(kTexturedObject), I<V>(0U));
}

/// Ports of the kernels that keep a surface of a sample.
template <class V, bool kInstanced>
struct SurfaceHitPorts {
  Local<V, WordRecord> surfaces;
  Hits<V, kInstanced> hits;
  Local<V, SurfacePointRecord> points;
  Local<V, DiffuseRecord> mattes;
  Local<V, PathRecord> paths;
  Objects<V, kInstanced> objects;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.surfaces));
    port(NAMED(p.hits));
    port(p.points, "places");
    port(NAMED(p.mattes));
    port(NAMED(p.paths));
    port(p.objects, kInstanced ? "instances" : "triangles");
  }
};

template <class V>
struct SurfaceHit {
  SurfacePointRecord<V> point;
  I<V> object;  ///< with the flag of a textured one
  PathRecord<V> path;
};
template <class V, bool kInstanced>
SurfaceHit<V> surface_hit(const I<V>& item, const SurfaceHitPorts<V, kInstanced>& at) {
  const I<V> slot = at.surfaces.load(item).word;
  const SurfacePointRecord<V> point = at.points.load(slot);
  const I<V> object = at.objects.load(index_of<V>(at.hits.load(slot))).object;
  return {point, marked<V>(object, at.mattes.load(slot).classes), at.paths.load(slot)};
}

template <bool kInstanced>
struct RecordGeometry {
  static constexpr std::string_view kName = kInstanced ? "record_geometry_instanced" : "record_geometry";
  static constexpr std::string_view kMeaning = kInstanced
                                                   ? "as record_geometry, with the object of the instance"
                                                   : "first hit -> its sample's geometry: object, normal, position";
  template <class V>
  struct Ports : SurfaceHitPorts<V, kInstanced> {
    Local<V, GeometryRecord> geometry;
    static void describe(auto& p, auto&& port) {
      SurfaceHitPorts<V, kInstanced>::describe(p, port);
      port(NAMED(p.geometry));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SurfaceHit<V> hit = surface_hit<V, kInstanced>(item, at);
    at.geometry.store(hit.path.sample, {hit.point.normal, hit.object, hit.point.position, 0U});
  }
};

template <bool kInstanced>
struct RecordTraits {
  static constexpr std::string_view kName = kInstanced ? "record_traits_instanced" : "record_traits";
  static constexpr std::string_view kMeaning = kInstanced
                                                   ? "as record_traits, with the object of the instance"
                                                   : "first hit -> its sample's traits: object, normal, no shadow yet";
  template <class V>
  struct Ports : SurfaceHitPorts<V, kInstanced> {
    Local<V, TraitsRecord> traits;
    static void describe(auto& p, auto&& port) {
      SurfaceHitPorts<V, kInstanced>::describe(p, port);
      port(NAMED(p.traits));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SurfaceHit<V> hit = surface_hit<V, kInstanced>(item, at);
    at.traits.store(hit.path.sample, {hit.point.normal, hit.object, 0U});
  }
};

}  // namespace kernels
