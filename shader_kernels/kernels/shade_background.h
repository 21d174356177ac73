#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "sim/named.h"

namespace kernels {

struct ShadeBackground {
  static constexpr std::string_view kName = "shade_background";
  static constexpr std::string_view kMeaning = "miss -> background radiance into its sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> misses;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours;
    Vec3<V> background;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.misses));
      port(NAMED(p.paths));
      port(NAMED(p.colours));
      port(NAMED(p.background));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const PathRecord<V> path = at.paths.load(at.misses.load(item).word);
    add_light<V>(at.colours, path.sample, path.throughput * at.background);
  }
};

}  // namespace kernels
