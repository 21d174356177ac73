#pragma once
#include <string_view>

#include "shader_kernels/ports.h"

namespace kernels {

/// Fetches what the hit triangle says of the surface and leaves it in the tile buffer for the executors. Only shading
/// normals are known: where one disagrees with its triangle, at silhouettes, a ray may be mirrored into the surface.
struct ShadeSurface {
  static constexpr std::string_view kName = "shade_surface";
  static constexpr std::string_view kMeaning = "hit -> surface: position, normal, texture coordinates, base colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, RayRecord> rays;
    Local<V, HitRecord> hits;
    Attributes<V> attributes;
    Materials<V> materials;
    Local<V, PlaceRecord> places;
    Local<V, MatteRecord> mattes;
    Local<V, TexcoordRecord> texcoords;
    static void describe(auto& p, auto&& port) {
      port(p.surfaces, "surfaces");
      port(p.rays, "rays");
      port(p.hits, "hits");
      port(p.attributes, "attributes");
      port(p.materials, "materials");
      port(p.places, "places");
      port(p.mattes, "mattes");
      port(p.texcoords, "texcoords");
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const RayRecord<V> ray = at.rays.load(slot);
    const HitRecord<V> hit = at.hits.load(slot);
    const AttributeFields<V> a = at.attributes.load(hit.triangle);
    const MaterialFields<V> m = at.materials.load(a.material);

    const F<V> first = 1.0F - hit.u - hit.v;
    const Vec3<V> normal = normalised(a.normal0 * first + a.normal1 * hit.u + a.normal2 * hit.v);
    const F<V> side = select(dot(normal, ray.direction) <= 0.0F, F<V>(1.0F), F<V>(-1.0F));
    at.places.store(slot, {ray.origin + ray.direction * hit.t, a.material, normal * side, side});

    const Vec3<V> diffuse = m.base_colour * ((1.0F - m.mirror) * (1.0F - m.transmission));
    at.mattes.store(slot, {diffuse, classes<V>(m, largest(diffuse))});
    at.texcoords.store(
        slot, {a.u0 * first + a.u1 * hit.u + a.u2 * hit.v, a.v0 * first + a.v1 * hit.u + a.v2 * hit.v, m.base_texture});
  }

 private:
  template <class V>
  static I<V> classes(const MaterialFields<V>& m, const F<V>& diffuse) {
    const auto bit = [](const M<V>& mask, Class c) {
      return select(mask, I<V>(static_cast<std::uint32_t>(c)), I<V>(0U));
    };
    const F<V> zero = 0.0F;
    const M<V> is_diffuse = zero < diffuse;
    return bit(both(is_diffuse, m.base_texture < traces::kNoTexture), kTextured) | bit(is_diffuse, kDiffuse) |
           bit(zero < max(m.mirror, m.transmission), kMirror) | bit(zero < m.transmission, kGlass) |
           bit(zero < largest(m.emission), kEmissive);
  }
};

}  // namespace kernels
