#pragma once
#include <string_view>

#include "shader_kernels/kernels/hashed_rays.h"
#include "shader_kernels/kernels/shade_diffuse.h"

namespace kernels {

/// A light that is a disc across its direction, and a ray's share of it.
template <class V>
struct DiscUniforms {
  Vec3<V> across_x, across_y;  ///< as long as its radius
  F<V> radius, share;
  static void describe(auto& d, auto&& port) {
    port(d.across_x, "disc.across_x");
    port(d.across_y, "disc.across_y");
    port(d.radius, "disc.radius");
    port(d.share, "disc.share");
  }
};

template <class V>
struct ShadeDiscPorts : ShadeDiffuse::Ports<V> {
  Local<V, RayRecord> rays;
  DiscUniforms<V> disc;
  DrawUniforms<V> draw;
  static void describe(auto& p, auto&& port) {
    ShadeDiffuse::Ports<V>::describe(p, port);
    port(NAMED(p.rays));
    DiscUniforms<V>::describe(p.disc, port);
    DrawUniforms<V>::describe(p.draw, port);
  }
};

/// In place of shade_diffuse where shadows are soft: one launch per light and ray. Rays go to points of the light's
/// disc, and end one radius before it: so they never reach into the lamp that it stands for. The light is that of the
/// disc's centre. With kShareAlone rays bring their share alone, of light that samples know.
template <bool kShareAlone>
struct ShadeDisc {
  static constexpr std::string_view kName = kShareAlone ? "shade_soft_share" : "shade_soft";
  static constexpr std::string_view kMeaning =
      kShareAlone ? "diffuse surface, one light -> shadow ray to a point of it, with its share"
                  : "diffuse surface, one light -> shadow ray to a point of it, with a share of its light";
  template <class V>
  using Ports = ShadeDiscPorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    shade<V>(at.diffuse.load(item).word, AllItems{}, at);
  }
  /// Acts where `mask` holds.
  template <class V>
  static void shade(const I<V>& slot, const auto& mask, Ports<V>& at) {
    const SurfacePointRecord<V> point = at.points.load(slot);
    const PathRecord<V> path = at.paths.load(slot);
    const auto [to_light, inverse_distance, light] =
        diffuse_light<V>(point, path, at.mattes.load(slot).diffuse, at.light);
    const DrawnPoint<V> aim = on_disc<V>(drawn<V>(at.rays.load(slot).direction, at.draw));
    const Vec3<V> direction = to_light + at.disc.across_x * aim.x + at.disc.across_y * aim.y;

    const I<V> out = at.emitted.next(both_of<V>(mask, F<V>(0.0F) < largest(light)));
    const F<V> t_min = at.epsilon * inverse_distance;
    const F<V> before = max(at.disc.radius * inverse_distance, t_min);
    at.shadow_rays.store(out, {point.position, t_min, direction, at.light.reach - before});
    const F<V>& share = at.disc.share;
    if constexpr (kShareAlone) {
      at.shadow_paths.store(out, {{share, share, share}, path.sample});
    } else {
      at.shadow_paths.store(out, {light * share, path.sample});
    }
  }
};
using ShadeSoft = ShadeDisc<false>;
using ShadeSoftShare = ShadeDisc<true>;

}  // namespace kernels
