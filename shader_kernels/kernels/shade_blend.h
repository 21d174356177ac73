#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Light that passes straight on is shade_straight's part.
struct ShadeBlend {
  static constexpr std::string_view kName = "shade_blend";
  static constexpr std::string_view kMeaning = "blended surface -> all that it sends out, times its alpha";
  template <class V>
  struct Ports {
    Local<V, WordRecord> blended;
    Local<V, DiffuseRecord> mattes;
    Local<V, SpecularRecord> optics;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.blended));
      port(NAMED(p.mattes));
      port(NAMED(p.optics));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.blended.load(item).word;
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    SpecularRecord<V> optics = at.optics.load(slot);
    at.mattes.store(slot, {matte.diffuse * optics.alpha, matte.classes});
    optics.mirrored = optics.mirrored * optics.alpha;
    optics.entering = optics.entering * optics.alpha;
    optics.kept = optics.alpha;
    at.optics.store(slot, optics);
  }
};

}  // namespace kernels
