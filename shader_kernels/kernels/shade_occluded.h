#pragma once
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// Corrects shade_ambient, which knows nothing of occlusion.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeOccluded {
  static constexpr std::string_view kName =
      by_filter<kMips>("shade_occluded", "shade_occluded_mip", "shade_occluded_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("surface with an occlusion texture -> ambient light taken back",
                       "as shade_occluded, from the nearest mip level", "as shade_occluded, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Details<V> details;
    Local<V, ColourRecord> colours;
    Vec3<V> ambient;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.details));
      port(NAMED(p.colours));
      port(NAMED(p.ambient));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const DiffuseRecord<V> matte = at.mattes.load(slot);
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> other = at.tangents.load(slot);
    const PathRecord<V> path = at.paths.load(slot);
    const DetailFields<V> m = at.details.load(at.points.load(slot).material);
    const auto texel = at.look_up(m.occlusion_texture, matte.classes, traces::kOcclusionSecond, uv, other);
    const F<V> taken = (texel.linear(0) - 1.0F) * m.occlusion_strength;
    add_light<V>(at.colours, path.sample, path.throughput * matte.diffuse * at.ambient * taken);
  }
};

}  // namespace kernels
