#pragma once
#include <string_view>

#include "shader_kernels/kernels/at_once.h"
#include "shader_kernels/kernels/diffuse_light.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// One launch per light: an item is a surface.
struct ShadeDiffuse {
  static constexpr std::string_view kName = "shade_diffuse";
  static constexpr std::string_view kMeaning = "diffuse surface, one light -> shadow ray that brings its light";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, RayRecord> shadow_rays;
    Local<V, PathRecord> shadow_paths;
    Counter<V> emitted;
    LightUniforms<V> light;
    F<V> epsilon;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.shadow_rays));
      port(NAMED(p.shadow_paths));
      port(NAMED(p.emitted));
      LightUniforms<V>::describe(p.light, port);
      port(NAMED(p.epsilon));
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
    const auto [to_light, inverse_distance, light] =
        diffuse_light<V>(point, path, at.mattes.load(slot).diffuse, at.light);

    const I<V> out = at.emitted.next(both_of<V>(mask, F<V>(0.0F) < largest(light)));
    const F<V> t_min = at.epsilon * inverse_distance;
    at.shadow_rays.store(out, {point.position, t_min, to_light, at.light.reach - t_min});
    at.shadow_paths.store(out, {light, path.sample});
  }
};

}  // namespace kernels
