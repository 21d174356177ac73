#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

struct CombineShadow {
  static constexpr std::string_view kName = "combine_shadow";
  static constexpr std::string_view kMeaning = "shadow ray -> its light into its sample, unless something was hit";
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, ColourRecord> colours;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.shadow_hits));
      port(NAMED(p.shadow_paths));
      port(NAMED(p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const M<V> lit = at.shadow_hits.load(item).triangle == traces::kNoHit;
    const PathRecord<V> path = at.shadow_paths.load(item);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    add_light<V>(at.colours, path.sample, select(lit, path.throughput, none));
  }
};

}  // namespace kernels
