#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// Base textures that shade_textured does not cover: with second texture coordinates, with an alpha that counts, or of
/// surfaces whose mirror wants to know the colour.
struct ShadeBase {
  static constexpr std::string_view kName = "shade_base";
  static constexpr std::string_view kMeaning = "surface -> base colour and alpha times a fetch";
  template <class V>
  struct Ports : DetailPorts<V> {
    Local<V, SpecularRecord> optics;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V>::describe(p, port);
      port(NAMED(p.optics));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> other = at.tangents.load(slot);
    SpecularRecord<V> optics = at.optics.load(slot);
    const Sample<V> base = at.look_up(uv.texture, matte.classes, traces::kBaseSecond, uv.u, uv.v, other);
    at.mattes.store(slot, {matte.diffuse * base.colour(), matte.classes});
    optics.alpha = optics.alpha * base.linear(3);
    at.optics.store(slot, optics);
  }
};

}  // namespace kernels
