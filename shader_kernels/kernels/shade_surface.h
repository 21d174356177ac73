#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/instances.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Fetches what the hit triangle says of the surface and leaves it in the tile buffer for the executors. Only shading
/// normals are known: where one disagrees with its triangle, at silhouettes, a ray may be mirrored into the surface.
template <bool kInstanced>
struct ShadeSurface {
  static constexpr std::string_view kName = kInstanced ? "shade_surface_instanced" : "shade_surface";
  static constexpr std::string_view kMeaning =
      kInstanced ? "as shade_surface, with the normal out of the mesh's space"
                 : "hit -> surface: position, normal, texture coordinates, base colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, RayRecord> rays;
    Hits<V, kInstanced> hits;
    Attributes<V> attributes;
    Instances<V> instances;  ///< wired if kInstanced
    Materials<V> materials;
    Local<V, SurfacePointRecord> points;
    Local<V, DiffuseRecord> mattes;
    Local<V, TexcoordRecord> texcoords;
    Local<V, SpecularRecord> optics;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.rays));
      port(NAMED(p.hits));
      port(NAMED(p.attributes));
      if constexpr (kInstanced) port(NAMED(p.instances));
      port(NAMED(p.materials));
      port(p.points, "places");
      port(NAMED(p.mattes));
      port(NAMED(p.texcoords));
      port(NAMED(p.optics));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const RayRecord<V> ray = at.rays.load(slot);
    const auto found = at.hits.load(slot);
    const HitRecord<V> hit = plain<V>(found);
    const AttributeFields<V> a = at.attributes.load(triangle_of<V>(hit));
    const MaterialFields<V> m = at.materials.load(a.material);

    const Weights<V> corners(hit);
    Vec3<V> interpolated = corners.interpolate(a.normal0, a.normal1, a.normal2);
    if constexpr (kInstanced) interpolated = normal_to_world<V>(at.instances.load(instance_of<V>(found)), interpolated);
    const Vec3<V> normal = normalised(interpolated);
    const F<V> side = select(dot(normal, ray.direction) <= 0.0F, F<V>(1.0F), F<V>(-1.0F));
    at.points.store(slot, {ray.origin + ray.direction * hit.t, a.material, normal * side, side});
    at.mattes.store(slot, {m.base_colour * m.diffuse_share, m.flags});
    at.texcoords.store(slot,
                       {corners.interpolate(a.u0, a.u1, a.u2), corners.interpolate(a.v0, a.v1, a.v2), m.base_texture});
    at.optics.store(slot, {m.mirrored, m.entering, m.ior, m.opacity, 1.0F});
  }
};

}  // namespace kernels
