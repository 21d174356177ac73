#pragma once
#include <string_view>

#include "shader_kernels/kernels/record_first_hit.h"
#include "sim/named.h"

namespace kernels {

/// A bounce behind the first. `way` tells bounces apart, so that the same objects met in another order are not taken
/// for the same.
template <class V>
struct BounceUniforms {
  I<V> way;
  I<V> mirrored, refracted;  ///< slots below `mirrored` go straight on, those below `refracted` were mirrored
  F<V> first;                ///< 1 for the bounce whose normals are kept, else 0
  static void describe(auto& b, auto&& port) {
    port(NAMED(b.way));
    port(NAMED(b.mirrored));
    port(NAMED(b.refracted));
    port(NAMED(b.first));
  }
};

/// One launch per bounce.
template <bool kInstanced>
struct RecordSecondary {
  static constexpr std::string_view kName = kInstanced ? "record_secondary_instanced" : "record_secondary";
  static constexpr std::string_view kMeaning = kInstanced ? "as record_secondary, with the object of the instance"
                                                          : "secondary hit -> into its sample's secondary geometry";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Hits<V, kInstanced> hits;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Objects<V, kInstanced> objects;
    Local<V, SecondaryRecord> secondary;
    BounceUniforms<V> bounce;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.hits));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(p.objects, kInstanced ? "instances" : "triangles");
      port(NAMED(p.secondary));
      BounceUniforms<V>::describe(p.bounce, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const Vec3<V> normal = at.points.load(slot).normal;
    const I<V> object = at.objects.load(index_of<V>(at.hits.load(slot))).object;
    const I<V> sample = at.paths.load(slot).sample;
    const SecondaryRecord<V> so_far = at.secondary.load(sample);
    const M<V> is_first = F<V>(0.0F) < at.bounce.first;
    const I<V> kind =
        select(slot < at.bounce.mirrored, I<V>(0U), select(slot < at.bounce.refracted, I<V>(1U), I<V>(2U)));
    const M<V> by_mirror = both(is_first, kind == 1U);
    const M<V> by_glass = both(is_first, kind == 2U);
    at.secondary.store(sample, {select(by_mirror, normal, so_far.mirror_normal),
                                so_far.objects + scrambled<V>(object ^ at.bounce.way ^ (kind << 28U)),
                                select(by_glass, normal, so_far.glass_normal), so_far.shadows});
  }
};

}  // namespace kernels
