#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/sample_neighbours.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

/// Coordinates on both sides of a texture's edge: one below the threshold, the other above one less it.
template <class V>
M<V> wraps(const F<V>& a, const F<V>& b, const F<V>& threshold) {
  const F<V> x = a - floor(a);
  const F<V> y = b - floor(b);
  return both(min(x, y) < threshold, 1.0F - threshold < max(x, y));
}

/// The inspector of adaptive undersampling: the seven similarity checks of Kim et al. 2016, table 1. Convexity has a
/// slack of 0.001 distances squared, without which rounding fails coplanar pairs. Base and occlusion textures are
/// sampled at the interpolated coordinates; second ones are not kept, so surfaces whose occlusion texture has those are
/// traced. Without kTextures the scene has no texture that could fail a check, without kColours the tile no global
/// colour.
template <bool kAlongY, bool kTextures, bool kColours = true>
struct CheckAttributes {
  static constexpr std::array<std::string_view, 8> kNames{"check_attributes_x_local_untextured",
                                                          "check_attributes_y_local_untextured",
                                                          "check_attributes_x_local",
                                                          "check_attributes_y_local",
                                                          "check_attributes_x_untextured",
                                                          "check_attributes_y_untextured",
                                                          "check_attributes_x",
                                                          "check_attributes_y"};
  static constexpr std::string_view kName = kNames[(kAlongY ? 1 : 0) + (kTextures ? 2 : 0) + (kColours ? 4 : 0)];
  static constexpr std::string_view kMeaning = "sample between two others -> stream passed or failed";
  template <class V>
  struct Ports : VerdictPorts<V> {
    Local<V, GeometryRecord> geometry;
    Local<V, SurfaceRecord> kept;
    Local<V, ColourRecord> globals;
    F<V> apart_squared, least_dot, texture, colour_squared;
    static void describe(auto& p, auto&& port) {
      VerdictPorts<V>::describe(p, port);
      port(NAMED(p.geometry));
      port(NAMED(p.kept));
      port(NAMED(p.globals));
      port(NAMED(p.apart_squared));
      port(NAMED(p.least_dot));
      port(NAMED(p.texture));
      port(NAMED(p.colour_squared));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, at.line);
    const GeometryRecord<V> g0 = at.geometry.load(b.before);
    const GeometryRecord<V> g1 = at.geometry.load(b.after);
    const SurfaceRecord<V> s0 = at.kept.load(b.before);
    const SurfaceRecord<V> s1 = at.kept.load(b.after);
    const Vec3<V> d = g1.position - g0.position;
    const F<V> squared = dot(d, d);
    const F<V> bend = dot(d, s0.plane) * -dot(d, s1.plane);
    I<V> failed = select(g0.object == g1.object, I<V>(0U), I<V>(bit(Check::kObject))) |
                  fails_if<V>(at.apart_squared < squared, Check::kPosition) |
                  fails_if<V>(dot(g0.normal, g1.normal) < at.least_dot, Check::kNormal) |
                  fails_if<V>(bend < squared * -1e-6F, Check::kConvexity) |
                  select(g0.shadows == g1.shadows, I<V>(0U), I<V>(bit(Check::kShadow)));
    if constexpr (kColours) {
      const F<V> colours = encoded_distance_squared<V>(at.globals.load(b.before).rgb, at.globals.load(b.after).rgb);
      failed = failed | fails_if<V>(at.colour_squared < colours, Check::kColour);
    }
    if constexpr (kTextures) {
      const M<V> over_edge = logical_or(wraps<V>(s0.u, s1.u, at.texture), wraps<V>(s0.v, s1.v, at.texture));
      const M<V> has_any = I<V>(0U) < (s0.classes & (traces::kTextured | traces::kOccluded));
      constexpr std::uint32_t kUnkept = traces::kOccluded | traces::kOcclusionSecond;
      failed = failed | fails_if<V>(both(over_edge, has_any), Check::kTexture) |
               select((s0.classes & kUnkept) == kUnkept, I<V>(bit(Check::kDetail)), I<V>(0U));
    }
    write_verdict<V>(at, b, failed);
  }
};

}  // namespace kernels
