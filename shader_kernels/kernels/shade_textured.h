#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// Base textures with the first texture coordinates whose alpha does not count; shade_base does the others.
struct ShadeTextured {
  static constexpr std::string_view kName = "shade_textured";
  static constexpr std::string_view kMeaning = "textured surface -> base colour times a bilinear fetch";
  template <class V>
  struct Ports {
    Local<V, WordRecord> textured;
    Local<V, TexcoordRecord> texcoords;
    Local<V, DiffuseRecord> mattes;
    Table<V, AxisRecord> axes;  ///< two per texture
    Texels<V> texels;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.textured));
      port(NAMED(p.texcoords));
      port(NAMED(p.mattes));
      port(NAMED(p.axes));
      port(NAMED(p.texels));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.textured.load(item).word;
    const TexcoordRecord<V> coordinates = at.texcoords.load(slot);
    const Sample<V> base = sample<V>(at.axes, at.texels, coordinates.texture, coordinates.u, coordinates.v);
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    at.mattes.store(slot, {matte.diffuse * base.colour(), matte.classes});
  }
};

}  // namespace kernels
