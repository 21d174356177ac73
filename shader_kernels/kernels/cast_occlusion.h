#pragma once
#include <string_view>

#include "shader_kernels/kernels/at_once.h"
#include "shader_kernels/kernels/hashed_rays.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

template <class V>
struct CastAmbientPorts {
  Local<V, WordRecord> diffuse;
  Local<V, SurfacePointRecord> points;
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, DiffuseRecord> mattes;
  Local<V, RayRecord> shadow_rays;
  Local<V, PathRecord> shadow_paths;
  Counter<V> emitted;
  Vec3<V> ambient;  ///< a ray's share of it
  F<V> epsilon, distance;
  DrawUniforms<V> draw;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.diffuse));
    port(p.points, "places");
    port(NAMED(p.rays));
    port(NAMED(p.paths));
    port(NAMED(p.mattes));
    port(NAMED(p.shadow_rays));
    port(NAMED(p.shadow_paths));
    port(NAMED(p.emitted));
    port(NAMED(p.ambient));
    port(NAMED(p.epsilon));
    port(NAMED(p.distance));
    DrawUniforms<V>::describe(p.draw, port);
  }
};

/// In place of shade_ambient where ambient light is occluded: one launch per ray. Directions are as frequent as the
/// cosine of their angle with the normal is large, so that all rays bring the same share. With kShareAlone they bring
/// nothing else, of light that samples know.
template <bool kShareAlone>
struct CastAmbient {
  static constexpr std::string_view kName = kShareAlone ? "cast_occlusion_share" : "cast_occlusion";
  static constexpr std::string_view kMeaning = kShareAlone
                                                   ? "diffuse surface -> ray that brings its share of ambient light"
                                                   : "diffuse surface -> ray that brings a share of its ambient light";
  template <class V>
  struct Ports : CastAmbientPorts<V> {
    F<V> share;  ///< wired if kShareAlone
    static void describe(auto& p, auto&& port) {
      CastAmbientPorts<V>::describe(p, port);
      if constexpr (kShareAlone) port(NAMED(p.share));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    shade<V>(at.diffuse.load(item).word, AllItems{}, at);
  }
  /// Acts where `mask` holds.
  template <class V>
  static void shade(const I<V>& slot, const auto& mask, Ports<V>& at) {
    const SurfacePointRecord<V> point = at.points.load(slot);
    const PathRecord<V> path = at.paths.load(slot);
    const Vec3<V> light = path.throughput * at.mattes.load(slot).diffuse * at.ambient;
    const DrawnPoint<V> square = drawn<V>(at.rays.load(slot).direction, at.draw);
    const DrawnPoint<V> disc = on_disc<V>(square);
    const Across<V> to_side = across<V>(point.normal);
    const Vec3<V> direction = to_side.x * disc.x + to_side.y * disc.y + point.normal * sqrt(1.0F - square.y);

    const I<V> out = at.emitted.next(both_of<V>(mask, F<V>(0.0F) < largest(light)));
    at.shadow_rays.store(out, {point.position, at.epsilon, direction, at.distance});
    if constexpr (kShareAlone) {
      at.shadow_paths.store(out, {{at.share, at.share, at.share}, path.sample});
    } else {
      at.shadow_paths.store(out, {light, path.sample});
    }
  }
};
using CastOcclusion = CastAmbient<false>;
using CastOcclusionShare = CastAmbient<true>;

}  // namespace kernels
