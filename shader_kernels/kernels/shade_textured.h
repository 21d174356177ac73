#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// Base textures with the first texture coordinates whose alpha does not count; shade_base does the others.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeTextured {
  static constexpr std::string_view kName =
      by_filter<kMips>("shade_textured", "shade_textured_mip", "shade_textured_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("textured surface -> base colour times a bilinear fetch",
                       "as shade_textured, from the nearest mip level", "as shade_textured, from two mip levels");
  template <class V>
  struct Ports : TexturePorts<V, kMips> {
    Local<V, WordRecord> textured;
    Local<V, TexcoordRecord> texcoords;
    Local<V, DiffuseRecord> mattes;
    Table<V, SrgbCodeRecord> srgb_codes;
    static void describe(auto& p, auto&& port) {
      TexturePorts<V, kMips>::describe(p, port);
      port(NAMED(p.textured));
      port(NAMED(p.texcoords));
      port(NAMED(p.mattes));
      port(NAMED(p.srgb_codes));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.textured.load(item).word;
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const auto base = look_up<V>(uv, at);
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    at.mattes.store(slot, {matte.diffuse * base.colour(at.srgb_codes), matte.classes});
  }

 private:
  template <class V>
  static auto look_up(const TexcoordRecord<V>& uv, const Ports<V>& at) {
    if constexpr (kMips == MipFilter::kNone) {
      return sample<V>(at.axes, at.texels, uv.texture, uv.u, uv.v);
    } else {
      return at.sample_level(texture_of<V, kMips>(uv), footprint_of<V>(uv.texture), uv.u, uv.v);
    }
  }
};

}  // namespace kernels
