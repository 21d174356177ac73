#pragma once
#include <string_view>

#include "shader_kernels/kernels/generate_visible_rays.h"
#include "sim/named.h"

namespace kernels {

/// The eye, and the way it looks: as long as depths are counted.
template <class V>
struct EyeUniforms {
  Vec3<V> position, axis;
  static void describe(auto& e, auto&& port) {
    port(e.position, "eye.place");
    port(e.axis, "eye.axis");
  }
};

struct RecordVisible {
  static constexpr std::string_view kName = "record_visible";
  static constexpr std::string_view kMeaning = "first hit -> its sample's normal, and depth along the view";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, VisibleRecord> visible;
    EyeUniforms<V> eye;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.visible));
      EyeUniforms<V>::describe(p.eye, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const SurfacePointRecord<V> point = at.points.load(slot);
    const I<V> sample = at.paths.load(slot).sample;
    at.visible.store(sample, {point.normal, dot(point.position - at.eye.position, at.eye.axis), 0U});
  }
};

/// A mirror's or glass's light is that of another sample than the surface's own, `apart` behind it: there its light is
/// added up and its geometry kept. Until it hits something it has that of a miss.
struct BeginBranch {
  static constexpr std::string_view kName = "begin_branch";
  static constexpr std::string_view kMeaning = "ray by a mirror or through glass -> of a sample of its own";
  template <class V>
  struct Ports {
    Local<V, PathRecord> next_paths;
    Local<V, VisibleRecord> visible;
    I<V> apart;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.next_paths));
      port(NAMED(p.visible));
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const PathRecord<V> path = at.next_paths.load(item);
    const I<V> sample = path.sample + at.apart;
    at.next_paths.store(item, {path.throughput, sample});
    at.visible.store(sample, visible_miss<V>());
  }
};

/// Depth is the way from the mirror, or from the side of the glass.
struct RecordBranchVisible {
  static constexpr std::string_view kName = "record_branch_visible";
  static constexpr std::string_view kMeaning =
      "hit behind a mirror or glass -> its sample's normal, and depth along the ray";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, HitRecord> hits;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, VisibleRecord> visible;
    F<V> depth_scale;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.hits));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.visible));
      port(NAMED(p.depth_scale));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const F<V> way = at.hits.load(slot).t;
    const Vec3<V> normal = at.points.load(slot).normal;
    const I<V> sample = at.paths.load(slot).sample;
    at.visible.store(sample, {normal, way * at.depth_scale, 0U});
  }
};

}  // namespace kernels
