#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// Base textures that shade_textured does not cover: with second texture coordinates, with an alpha that counts, or of
/// surfaces whose mirror or glass depends on the colour.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeBase {
  static constexpr std::string_view kName = by_filter<kMips>("shade_base", "shade_base_mip", "shade_base_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("surface -> base colour and alpha times a fetch", "as shade_base, from the nearest mip level",
                       "as shade_base, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SpecularRecord> optics;
    Table<V, SrgbCodeRecord> srgb_codes;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(NAMED(p.optics));
      port(NAMED(p.srgb_codes));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> other = at.tangents.load(slot);
    SpecularRecord<V> optics = at.optics.load(slot);
    const auto base = at.look_up(texture_of<V, kMips>(uv), matte.classes, traces::kBaseSecond, uv, other);
    const Vec3<V> colour = base.colour(at.srgb_codes);
    at.mattes.store(slot, {matte.diffuse * colour, matte.classes});
    optics.tint = optics.tint * colour;
    optics.alpha = optics.alpha * base.linear(3);
    at.optics.store(slot, optics);
  }
};

}  // namespace kernels
