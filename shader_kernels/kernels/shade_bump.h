#pragma once
#include <string_view>

#include "shader_kernels/kernels/sampling.h"
#include "sim/named.h"

namespace kernels {

/// A normal map in tangent space, as glTF has it. Where there is no tangent the normal stays; where the mapped normal
/// looks away from the ray it is turned back until the ray just grazes the surface.
template <MipFilter kMips = MipFilter::kNone>
struct ShadeBump {
  static constexpr std::string_view kName = by_filter<kMips>("shade_bump", "shade_bump_mip", "shade_bump_trilinear");
  static constexpr std::string_view kMeaning =
      by_filter<kMips>("surface with a normal map -> its normal from the map",
                       "as shade_bump, from the nearest mip level", "as shade_bump, from two mip levels");
  template <class V>
  struct Ports : DetailPorts<V, kMips> {
    Local<V, RayRecord> rays;
    Local<V, SurfacePointRecord> points;
    Details<V> details;
    static void describe(auto& p, auto&& port) {
      DetailPorts<V, kMips>::describe(p, port);
      port(NAMED(p.rays));
      port(p.points, "places");
      port(NAMED(p.details));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.stream.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    const TexcoordRecord<V> uv = at.texcoords.load(slot);
    const TangentRecord<V> frame = at.tangents.load(slot);
    const Vec3<V> direction = at.rays.load(slot).direction;
    SurfacePointRecord<V> point = at.points.load(slot);
    const DetailFields<V> m = at.details.load(point.material);
    const auto texel = at.look_up(m.normal_texture, classes, traces::kNormalSecond, uv, frame);

    const F<V> x = (texel.linear(0) * 2.0F - 1.0F) * m.normal_scale;
    const F<V> y = (texel.linear(1) * 2.0F - 1.0F) * m.normal_scale;
    const F<V> z = max(texel.linear(2) * 2.0F - 1.0F, F<V>(0.01F));
    const Vec3<V> normal = point.normal * point.side;  // the outside's
    const Vec3<V> bitangent = cross(normal, frame.tangent);
    const Vec3<V> mapped = frame.tangent * x + bitangent * (y * frame.handedness) + normal * z;
    const Vec3<V> facing = normalised(mapped) * point.side;
    const F<V> away = max(dot(facing, direction) + 0.01F, F<V>(0.0F));
    point.normal = normalised(facing - direction * away);
    at.points.store(slot, point);
  }
};

}  // namespace kernels
