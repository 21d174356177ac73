#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/at_once.h"
#include "shader_kernels/kernels/diffuse_light.h"
#include "sim/named.h"

namespace kernels {

/// One launch per light: as shade_diffuse where it is known already whether the light is seen.
struct ShadeVisible {
  static constexpr std::string_view kName = "shade_visible";
  static constexpr std::string_view kMeaning =
      "interpolated surface, one light -> its light, unless its shadow is known";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, GeometryRecord> geometry;
    Local<V, ColourRecord> colours;
    I<V> mark;
    LightUniforms<V> light;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.geometry));
      port(NAMED(p.colours));
      port(NAMED(p.mark));
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
    const M<V> dark = I<V>(0U) < (at.geometry.load(path.sample).shadows & at.mark);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    const Vec3<V> seen = select(both_of<V>(mask, F<V>(0.0F) < largest(light)), light, none);
    add_light<V>(at.colours, path.sample, select(dark, none, seen));
  }
};

}  // namespace kernels
