#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "sim/named.h"

namespace kernels {

struct ShadeEmission {
  static constexpr std::string_view kName = "shade_emission";
  static constexpr std::string_view kMeaning = "emissive surface -> its own light into its sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> emissive;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, SpecularRecord> optics;
    Materials<V> materials;
    Local<V, ColourRecord> colours;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.emissive));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.optics));
      port(NAMED(p.materials));
      port(NAMED(p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.emissive.load(item).word;
    const PathRecord<V> path = at.paths.load(slot);
    const MaterialFields<V> material = at.materials.load(at.points.load(slot).material);
    add_light<V>(at.colours, path.sample, path.throughput * material.emission * at.optics.load(slot).kept);
  }
};

}  // namespace kernels
