#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// The rule of traces/scene/gltf/materials/materials.h for each texel: how much is mirrored in which colour, and what
/// is left. The surface comes with its whole base colour as the diffuse one, and with what would enter if nothing were
/// mirrored.
template <MipFilter kMips = MipFilter::kNone>
struct ShadePhysical {
  static constexpr std::string_view kName =
      by_filter<kMips>("shade_physical", "shade_physical_mip", "shade_physical_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("surface with a metallic-roughness texture -> mirror and diffuse shares",
                       "as shade_physical, from the nearest mip level", "as shade_physical, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, SpecularRecord> optics;
    Details<V> details;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      port(NAMED(p.optics));
      port(NAMED(p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> other = at.tangents.load(slot);
    const DetailFields<V> m = at.details.load(at.points.load(slot).material);
    SpecularRecord<V> optics = at.optics.load(slot);
    const auto texel = at.look_up(m.metal_rough_texture, matte.classes, traces::kMetalRoughSecond, uv, other);

    const F<V> gloss = clamped<V>((0.5F - m.roughness * texel.linear(1)) * 2.5F);
    const F<V> metallic = m.metallic * texel.linear(2);
    const F<V> metal = gloss * metallic;
    const F<V> white = (gloss - metal) * m.dielectric + m.coat;
    const F<V> sum = metal + white;
    // Below 0.02 no rays for nothing; above 1 no more light than there is.
    const F<V> scale = select(sum < 0.02F, F<V>(0.0F), 1.0F / max(sum, F<V>(1.0F)));
    optics.mirrored = (matte.diffuse * metal + Vec3<V>{white, white, white}) * scale;
    const F<V> left = 1.0F - sum * scale;
    const Vec3<V> diffuse = matte.diffuse * (left * (1.0F - optics.entering));
    optics.entering = optics.entering * left;
    const auto bit = [](const M<V>& mask, traces::MaterialFlag flag) {
      return select(mask, I<V>(static_cast<std::uint32_t>(flag)), I<V>(0U));
    };
    const I<V> classes = matte.classes | bit(F<V>(0.0F) < largest(diffuse), traces::kDiffuse) |
                         bit(F<V>(0.0F) < largest(optics.mirrored), traces::kMirror);
    at.mattes.store(slot, {diffuse, classes});
    at.optics.store(slot, optics);
  }
};

}  // namespace kernels
