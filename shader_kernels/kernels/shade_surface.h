#pragma once
#include <string_view>
#include <type_traits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/sampling.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/records.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

// Kernels that read more of a hit than its triangle have two variants. kInstanced is for scenes with instances (two
// levels), where a hit names its instance and mesh data are in the space of the mesh.

template <class V, bool kInstanced>
using Hits = std::conditional_t<kInstanced, Local<V, InstanceHitRecord>, Local<V, HitRecord>>;

template <class V>
HitRecord<V> decode_hit_weights(const HitRecord<V>& hit) {
  return hit;
}
template <class V>
HitRecord<V> decode_hit_weights(const InstanceHitRecord<V>& hit) {
  constexpr float kStep = 1.0F / static_cast<float>(traces::kWeightOne);
  const auto weight = [](const I<V>& word) { return to_float(word >> traces::kHalfBits) * kStep; };
  return {hit.t, weight(hit.u), weight(hit.v), hit.triangle};
}

template <class V>
I<V> triangle_index_of(const auto& hit) {
  return hit.triangle & traces::kTriangleMask;
}
template <class V>
I<V> instance_index_of(const InstanceHitRecord<V>& hit) {
  return (hit.u & traces::kHalfMask) | ((hit.v & traces::kHalfMask) << traces::kHalfBits);
}

/// Transforms a normal from mesh to world space with the transposed world-to-mesh matrix. The result is not normalised.
template <class V>
Vec3<V> normal_to_world(const InstanceFields<V>& instance, const Vec3<V>& n) {
  return instance.row0 * n.x + instance.row1 * n.y + instance.row2 * n.z;
}

/// Returns the texture density of a triangle in world space: the square root of texture area over world area. The
/// length of `n`, its normal in mesh space, is the density in mesh space. `length_in_world`: length of
/// normal_to_world(n).
template <class V>
F<V> world_texture_density(const InstanceFields<V>& instance, const Vec3<V>& n, const F<V>& length_in_world) {
  const F<V> squared = dot(n, n);
  return sqrt(squared * sqrt(squared) / (instance.volume * length_in_world));
}

/// Transforms a tangent from mesh to world space; the result has length 1 or 0. The instance stores the rows of the
/// matrix from world to mesh space. The columns of its inverse are cross products of these rows, divided by the
/// determinant. Of the determinant only the sign matters (`handedness`), because the result is normalised.
template <class V>
Vec3<V> tangent_to_world(const InstanceFields<V>& instance, const Vec3<V>& t) {
  const Vec3<V> along = cross(instance.row1, instance.row2) * t.x + cross(instance.row2, instance.row0) * t.y +
                        cross(instance.row0, instance.row1) * t.z;
  return unit_vector(along) * instance.handedness;
}

template <class V>
struct VertexColour {
  Vec3<V> rgb;
  F<V> alpha;
};

template <class V>
VertexColour<V> vertex_colour(const Weights<V>& corners, const VertexFields<V>& vertices) {
  const auto low = [&](const I<V>& a, const I<V>& b, const I<V>& c) {
    return corners.interpolate_int(a & 0xffffU, b & 0xffffU, c & 0xffffU) * (1.0F / 65535.0F);
  };
  const auto high = [&](const I<V>& a, const I<V>& b, const I<V>& c) {
    return corners.interpolate_int(a >> 16U, b >> 16U, c >> 16U) * (1.0F / 65535.0F);
  };
  return {{low(vertices.red_green0, vertices.red_green1, vertices.red_green2),
           high(vertices.red_green0, vertices.red_green1, vertices.red_green2),
           low(vertices.blue_alpha0, vertices.blue_alpha1, vertices.blue_alpha2)},
          high(vertices.blue_alpha0, vertices.blue_alpha1, vertices.blue_alpha2)};
}

/// Returns the name of a kernel variant: one of four names, with or without instances and with or without ray cones.
template <bool kInstanced, bool kCones>
constexpr std::string_view variant_name_by_instances_and_cones(std::string_view plain, std::string_view instanced,
                                                               std::string_view cones,
                                                               std::string_view cones_instanced) {
  return kCones ? (kInstanced ? cones_instanced : cones) : (kInstanced ? instanced : plain);
}

/// Smallest cosine with which a cone's footprint on a surface is computed; at more grazing angles the footprint grows
/// no further.
inline constexpr float kLeastCosine = 0x1p-6F;

/// Fetches the surface at a hit and stores it in the tile buffer. Only shading normals are read. At silhouettes, where
/// they disagree with the triangle's plane, a ray may be mirrored into the surface.
///
/// With kCones it also computes the footprint of the ray's cone in texture coordinates, along its longer axis. Mirrors
/// and refraction keep the cone's spread. The path from the eye to the origin of the last ray counts as a straight
/// line.
template <bool kInstanced, bool kCones = false>
struct ShadeSurface {
  static constexpr std::string_view kName = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "shade_surface", "shade_surface_instanced", "shade_surface_cones", "shade_surface_cones_instanced");
  static constexpr std::string_view kMeaning = variant_name_by_instances_and_cones<kInstanced, kCones>(
      "hit -> surface: position, normal, texture coordinates, base colour",
      "as shade_surface, with the normal out of the mesh's space", "as shade_surface, with the footprint of ray cones",
      "as shade_surface_cones, with the normal out of the mesh's space");
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, RayRecord> rays;
    Hits<V, kInstanced> hits;
    Attributes<V> attributes;
    Instances<V> instances;  ///< instance records; only in kInstanced variants
    Materials<V> materials;
    Local<V, SurfacePointRecord> points;
    Local<V, DiffuseRecord> mattes;
    Local<V, TexcoordRecord> texcoords;
    Local<V, SpecularRecord> optics;
    ConeUniforms<V> cone;  ///< ray cones of the frame; only in kCones variants
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.rays, p.hits, p.attributes));
      if constexpr (kInstanced) port(NAMED(p.instances));
      port(NAMED(p.materials));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.mattes, p.texcoords, p.optics));
      if constexpr (kCones) ConeUniforms<V>::describe(p.cone, port);
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const RayRecord<V> ray = io.rays.load(slot);
    const auto found = io.hits.load(slot);
    const HitRecord<V> hit = decode_hit_weights<V>(found);
    const AttributeFields<V> a = io.attributes.load(triangle_index_of<V>(hit));
    const MaterialFields<V> m = io.materials.load(a.material);

    const Weights<V> corners(hit);
    Vec3<V> interpolated = corners.interpolate(a.normal0, a.normal1, a.normal2);
    InstanceFields<V> instance;
    const Vec3<V> of_mesh = interpolated;
    if constexpr (kInstanced) {
      instance = io.instances.load(instance_index_of<V>(found));
      interpolated = normal_to_world<V>(instance, interpolated);
    }
    const F<V> length = sqrt(max(dot(interpolated, interpolated), F<V>(1e-30F)));
    const Vec3<V> normal = interpolated * (1.0F / length);
    const F<V> cosine = dot(normal, ray.direction);
    const F<V> side = select(cosine <= 0.0F, F<V>(1.0F), F<V>(-1.0F));
    I<V> texture = m.base_texture;
    if constexpr (kCones) {
      const Vec3<V> before = ray.origin - io.cone.eye;
      const F<V> width = (sqrt(dot(before, before)) + hit.t) * io.cone.spread;
      F<V> density = length;
      if constexpr (kInstanced) density = world_texture_density<V>(instance, of_mesh, length);
      texture = pack_footprint<V>(texture, width * density / max(abs(cosine), F<V>(kLeastCosine)));
    }
    io.points.store(slot, {ray.origin + ray.direction * hit.t, a.material, normal * side, side});
    io.mattes.store(slot, {m.base_colour * m.diffuse_share, m.flags});
    io.texcoords.store(slot, {corners.interpolate(a.u0, a.u1, a.u2), corners.interpolate(a.v0, a.v1, a.v2), texture});
    io.optics.store(slot, {m.mirrored, m.entering, m.base_colour, m.ior, m.opacity, 1.0F});
  }
};

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
    Instances<V> instances;  ///< instance records; only in kInstanced variants
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.vertexed, p.hits, p.mattes, p.optics, p.tangents, p.vertices));
      if constexpr (kInstanced) port(NAMED(p.instances));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.vertexed.load(item).word;
    const auto found = io.hits.load(slot);
    const HitRecord<V> hit = decode_hit_weights<V>(found);
    const DiffuseRecord<V> matte = io.mattes.load(slot);
    SpecularRecord<V> optics = io.optics.load(slot);
    const VertexFields<V> vertex = io.vertices.load(triangle_index_of<V>(hit));
    const Weights<V> corners(hit);
    const VertexColour<V> colour = vertex_colour<V>(corners, vertex);
    io.mattes.store(slot, {matte.diffuse * colour.rgb, matte.classes});
    optics.tint = optics.tint * colour.rgb;
    optics.alpha = optics.alpha * colour.alpha;
    io.optics.store(slot, optics);
    const auto signed_byte = [&](std::uint32_t byte) {
      const auto part = [&](const I<V>& word) { return extract_byte<V>(word, byte); };
      return (corners.interpolate_int(part(vertex.tangent0), part(vertex.tangent1), part(vertex.tangent2)) - 128.0F) *
             (1.0F / 127.0F);
    };
    Vec3<V> tangent{signed_byte(0), signed_byte(1), signed_byte(2)};
    F<V> handedness = signed_byte(3);
    if constexpr (kInstanced) {
      const InstanceFields<V> instance = io.instances.load(instance_index_of<V>(found));
      tangent = tangent_to_world<V>(instance, tangent);
      handedness = handedness * instance.handedness;
    }
    io.tangents.store(slot, {tangent, handedness, corners.interpolate(vertex.u0, vertex.u1, vertex.u2),
                             corners.interpolate(vertex.v0, vertex.v1, vertex.v2)});
  }
};

}  // namespace kernels
