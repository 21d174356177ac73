#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

template <MipFilter kMips = MipFilter::kNone>
struct ShadeGlow {
  static constexpr std::string_view kName = by_filter<kMips>("shade_glow", "shade_glow_mip", "shade_glow_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("surface with an emission texture -> its own light into its sample",
                       "as shade_glow, from the nearest mip level", "as shade_glow, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, SpecularRecord> optics;
    Details<V> details;
    Local<V, ColourRecord> colours;
    Table<V, SrgbCodeRecord> srgb_codes;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.optics));
      port(NAMED(p.details));
      port(NAMED(p.colours));
      port(NAMED(p.srgb_codes));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> other = at.tangents.load(slot);
    const PathRecord<V> path = at.paths.load(slot);
    const F<V> kept = at.optics.load(slot).kept;
    const DetailFields<V> m = at.details.load(at.points.load(slot).material);
    const auto texel = at.look_up(m.emission_texture, classes, traces::kEmissionSecond, uv, other);
    add_light<V>(at.colours, path.sample, path.throughput * (m.emission * texel.colour(at.srgb_codes)) * kept);
  }
};

}  // namespace kernels
