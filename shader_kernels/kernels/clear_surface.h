#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// As clear_geometry, for samples that keep their surface.
struct ClearSurface {
  static constexpr std::string_view kName = "clear_surface";
  static constexpr std::string_view kMeaning = "sample -> its geometry and surface are those of a miss";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, GeometryRecord> geometry;
    Local<V, SurfaceRecord> kept;
    Local<V, ColourRecord> globals;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.geometry));
      port(NAMED(p.kept));
      port(NAMED(p.globals));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    at.geometry.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, none, 0U});
    at.kept.store(sample, {none, 0U, {0.0F, 0.0F, 1.0F}, 0.0F, 0.0F, 0U, 0U});
    at.globals.store(sample, {none});
  }
};

}  // namespace kernels
