#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/at_once.h"
#include "shader_kernels/kernels/diffuse_light.h"
#include "sim/named.h"

namespace kernels {

/// In place of shade_diffuse where a frame has no shadows. One launch per light.
struct ShadeOpen {
  static constexpr std::string_view kName = "shade_open";
  static constexpr std::string_view kMeaning = "diffuse surface, one light -> its light into its sample, no shadow";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, ColourRecord> colours;
    LightUniforms<V> light;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.colours));
      LightUniforms<V>::describe(p.light, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    shade<V>(at.diffuse.load(item).word, AllItems{}, at);
  }
  /// Acts where `mask` holds.
  template <class V>
  static void shade(const I<V>& slot, const auto& mask, Ports<V>& at) {
    const PathRecord<V> path = at.paths.load(slot);
    const Vec3<V> light = diffuse_light<V>(at.points.load(slot), path, at.mattes.load(slot).diffuse, at.light).light;
    const M<V> is_lit = both_of<V>(mask, F<V>(0.0F) < largest(light));
    add_light<V>(at.colours, path.sample, select(is_lit, light, Vec3<V>{0.0F, 0.0F, 0.0F}));
  }
};

}  // namespace kernels
