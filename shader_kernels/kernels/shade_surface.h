#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/instances.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// One of the names, by how surfaces are fetched.
template <bool kInstanced, bool kCones>
constexpr std::string_view by_surface(std::string_view plain, std::string_view instanced, std::string_view cones,
                                      std::string_view cones_instanced) {
  return kCones ? (kInstanced ? cones_instanced : cones) : (kInstanced ? instanced : plain);
}

/// Cones that graze a surface cover no more of it than those at this cosine do.
inline constexpr float kLeastCosine = 0x1p-6F;

/// Fetches what the hit triangle says of the surface and leaves it in the tile buffer for the executors. Only shading
/// normals are known: where one disagrees with its triangle, at silhouettes, a ray may be mirrored into the surface.
/// With cones it also says how wide the ray's is there in texture coordinates, lengthwise. A cone keeps its spread
/// where it is mirrored or refracted, and is taken to have come straight from the eye to where its last ray begins.
template <bool kInstanced, bool kCones = false>
struct ShadeSurface {
  static constexpr std::string_view kName = by_surface<kInstanced, kCones>(
      "shade_surface", "shade_surface_instanced", "shade_surface_cones", "shade_surface_cones_instanced");
  static constexpr std::string_view kMeaning = by_surface<kInstanced, kCones>(
      "hit -> surface: position, normal, texture coordinates, base colour",
      "as shade_surface, with the normal out of the mesh's space", "as shade_surface, with the footprint of ray cones",
      "as shade_surface_cones, with the normal out of the mesh's space");
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
    ConeUniforms<V> cone;  ///< wired if kCones
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
      if constexpr (kCones) ConeUniforms<V>::describe(p.cone, port);
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
    InstanceFields<V> instance;
    const Vec3<V> of_mesh = interpolated;
    if constexpr (kInstanced) {
      instance = at.instances.load(instance_of<V>(found));
      interpolated = normal_to_world<V>(instance, interpolated);
    }
    const F<V> length = sqrt(max(dot(interpolated, interpolated), F<V>(1e-30F)));
    const Vec3<V> normal = interpolated * (1.0F / length);
    const F<V> cosine = dot(normal, ray.direction);
    const F<V> side = select(cosine <= 0.0F, F<V>(1.0F), F<V>(-1.0F));
    I<V> texture = m.base_texture;
    if constexpr (kCones) {
      const Vec3<V> before = ray.origin - at.cone.eye;
      const F<V> width = (sqrt(dot(before, before)) + hit.t) * at.cone.spread;
      F<V> density = length;
      if constexpr (kInstanced) density = density_in_world<V>(instance, of_mesh, length);
      texture = with_footprint<V>(texture, width * density / max(abs(cosine), F<V>(kLeastCosine)));
    }
    at.points.store(slot, {ray.origin + ray.direction * hit.t, a.material, normal * side, side});
    at.mattes.store(slot, {m.base_colour * m.diffuse_share, m.flags});
    at.texcoords.store(slot, {corners.interpolate(a.u0, a.u1, a.u2), corners.interpolate(a.v0, a.v1, a.v2), texture});
    at.optics.store(slot, {m.mirrored, m.entering, m.base_colour, m.ior, m.opacity, 1.0F});
  }
};

}  // namespace kernels
