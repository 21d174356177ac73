#pragma once
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/effects.h"
#include "shader_kernels/kernels/microfacets.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Ports of kernels that emit secondary rays from the surfaces in a list, `stream`.
template <class V>
struct SecondaryPorts {
  Local<V, WordRecord> stream;
  Local<V, SurfacePointRecord> points;
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, SpecularRecord> optics;
  Local<V, RayRecord> next_rays;
  Local<V, PathRecord> next_paths;
  Counter<V> emitted;
  F<V> epsilon, min_weight;
  static constexpr void describe(auto& p, auto&& port) {
    port(NAMED(p.stream));
    port(p.points, "places");
    name_all(port, NAMED_ALL(p.rays, p.paths, p.optics, p.next_rays, p.next_paths, p.emitted, p.epsilon, p.min_weight));
  }
};

/// Emits the next ray of a path if its throughput is large enough to be visible.
template <class V>
void emit_secondary_ray(SecondaryPorts<V>& io, const Vec3<V>& origin, const Vec3<V>& direction,
                        const PathRecord<V>& path) {
  const I<V> out = io.emitted.next_index(io.min_weight < max_channel(path.throughput));
  io.next_rays.store(out, {origin, io.epsilon, direction, std::numeric_limits<float>::infinity()});
  io.next_paths.store(out, path);
}

/// A path's hit on a mirroring or transmitting surface.
template <class V>
struct SpecularHit {
  SurfacePointRecord<V> point;
  Vec3<V> direction;
  PathRecord<V> path;
  SpecularRecord<V> optics;
  Interface<V> glass;
};
template <class V>
SpecularHit<V> load_specular_hit(const I<V>& item, const SecondaryPorts<V>& io) {
  const I<V> slot = io.stream.load(item).word;
  const SurfacePointRecord<V> point = io.points.load(slot);
  const Vec3<V> direction = io.rays.load(slot).direction;
  const PathRecord<V> path = io.paths.load(slot);
  const SpecularRecord<V> optics = io.optics.load(slot);
  return {point, direction, path, optics, make_interface<V>(direction, point.normal, point.side, optics.ior)};
}

/// Emits mirrored rays from mirrors and from glass. A surface that is both emits one ray with the sum of their weights.
struct ShadeMirror {
  static constexpr std::string_view kName = "shade_mirror";
  static constexpr std::string_view kMeaning = "mirror or glass surface -> reflection ray";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const auto [point, direction, path, optics, glass] = load_specular_hit<V>(item, io);
    const F<V> share = optics.entering * glass.reflectance;
    const Vec3<V> tint = optics.mirrored + Vec3<V>{share, share, share};
    const Vec3<V> reflected = direction + point.normal * (2.0F * glass.cosine);
    emit_secondary_ray<V>(io, point.position, reflected, {path.throughput * tint, path.sample});
  }
};

/// Emits mirrored rays like shade_mirror. At rough surfaces one random microfacet of the GGX distribution mirrors.
struct ReflectRough {
  static constexpr std::string_view kName = "reflect_rough";
  static constexpr std::string_view kMeaning = "mirror, rough or glass surface -> reflection ray";
  template <class V>
  struct Ports : SecondaryPorts<V> {
    Local<V, DiffuseRecord> mattes;
    RandomPointUniforms<V> draw;
    static constexpr void describe(auto& p, auto&& port) {
      SecondaryPorts<V>::describe(p, port);
      port(NAMED(p.mattes));
      RandomPointUniforms<V>::describe(p.draw, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const auto [point, direction, path, optics, glass] = load_specular_hit<V>(item, io);
    const I<V> classes = io.mattes.load(io.stream.load(item).word).classes;
    const F<V> share = optics.entering * glass.reflectance;
    const Vec3<V> tint = optics.mirrored + Vec3<V>{share, share, share};
    const Vec3<V> reflected = direction + point.normal * (2.0F * glass.cosine);
    const FacetReflection<V> facet =
        reflect_by_facet<V>(direction, point.normal, random_point_in_square<V>(direction, io.draw), optics.mirrored,
                            optics.kept, alpha_of<V>(classes));
    const M<V> is_rough = I<V>(0U) < (classes & traces::kRoughnessMask);
    emit_secondary_ray<V>(io, point.position, select(is_rough, facet.direction, reflected),
                          {path.throughput * select(is_rough, facet.weight, tint), path.sample});
  }
};

/// Emits refracted rays. Refracted light, unlike mirrored light, is multiplied by the base colour once per surface
/// (KHR_materials_transmission). Total reflection leaves no throughput, so no ray is emitted.
struct ShadeGlass {
  static constexpr std::string_view kName = "shade_glass";
  static constexpr std::string_view kMeaning = "glass surface -> refraction ray";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const auto [point, direction, path, optics, glass] = load_specular_hit<V>(item, io);
    const F<V> bend = glass.eta * glass.cosine - sqrt(max(glass.inside, F<V>(0.0F)));
    const Vec3<V> refracted = direction * glass.eta + point.normal * bend;
    const F<V> share = optics.entering * (1.0F - glass.reflectance);
    emit_secondary_ray<V>(io, point.position, refracted, {path.throughput * (optics.tint * share), path.sample});
  }
};

struct ShadeStraight {
  static constexpr std::string_view kName = "shade_straight";
  static constexpr std::string_view kMeaning = "blended surface -> refraction ray that goes straight on";
  template <class V>
  using Ports = SecondaryPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.stream.load(item).word;
    const Vec3<V> position = io.points.load(slot).position;
    const Vec3<V> direction = io.rays.load(slot).direction;
    const PathRecord<V> path = io.paths.load(slot);
    const F<V> share = 1.0F - io.optics.load(slot).alpha;
    emit_secondary_ray<V>(io, position, direction, {path.throughput * share, path.sample});
  }
};

}  // namespace kernels
