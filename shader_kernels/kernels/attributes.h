#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/similarity.h"
#include "shader_kernels/kernels/uniforms.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

/// True if two texture coordinates are on opposite sides of a texture's edge: one below the threshold, the other above
/// 1 minus the threshold.
template <class V>
M<V> wraps(const F<V>& a, const F<V>& b, const F<V>& threshold) {
  const F<V> x = a - floor(a);
  const F<V> y = b - floor(b);
  return both(min(x, y) < threshold, 1.0F - threshold < max(x, y));
}

/// Inspector of undersample: the seven similarity checks of Kim et al. 2016, table 1.
///
/// 1. The convexity check has a slack of 0.001 squared distances, because rounding would fail coplanar pairs.
/// 2. Base and occlusion textures are read at the interpolated coordinates. Second coordinates are not kept, so a
///    surface whose occlusion texture needs them is traced.
/// 3. Without kTextures the scene has no textures to check; without kColours the tile has no global colours.
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
    static constexpr void describe(auto& p, auto&& port) {
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

/// Executor of undersample for samples that passed (Kim et al. 2016): interpolates the attributes of two references to
/// a surface, which is shaded next. Along x it also stores the attributes for the checks along y.
template <bool kAlongY>
struct InterpolateAttributes {
  static constexpr std::string_view kName = kAlongY ? "interpolate_attributes_y" : "interpolate_attributes_x";
  static constexpr std::string_view kMeaning = "sample that passed -> surface between its references, global colour";
  template <class V>
  struct Ports {
    Local<V, WordRecord> passed;
    LineUniforms<V> line;
    Local<V, GeometryRecord> geometry;
    Local<V, SurfaceRecord> kept;
    Local<V, ColourRecord> globals, colours;
    Local<V, WordRecord> surfaces;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, DiffuseRecord> mattes;
    Local<V, TexcoordRecord> texcoords;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.passed));
      LineUniforms<V>::describe(p.line, port);
      port(NAMED(p.geometry));
      port(NAMED(p.kept));
      port(NAMED(p.globals));
      port(NAMED(p.colours));
      port(NAMED(p.surfaces));
      port(p.points, "places");
      port(NAMED(p.paths));
      port(NAMED(p.mattes));
      port(NAMED(p.texcoords));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Passed<V> p = passed<V>(at.passed.load(item).word, at.line);
    const GeometryRecord<V> g = lerp_geometry<V>(at.geometry.load(p.before), at.geometry.load(p.after), p.weight);
    const SurfaceRecord<V> a = at.kept.load(p.before);
    const SurfaceRecord<V> b = at.kept.load(p.after);
    const Vec3<V> diffuse = lerp<V>(a.diffuse, b.diffuse, p.weight);
    const F<V> u = lerp<V>(a.u, b.u, p.weight);
    const F<V> v = lerp<V>(a.v, b.v, p.weight);
    const Vec3<V> global = lerp<V>(at.globals.load(p.before).rgb, at.globals.load(p.after).rgb, p.weight);
    at.geometry.store(p.sample, g);
    if constexpr (!kAlongY) {
      at.kept.store(p.sample,
                    {diffuse, a.classes, normalised(lerp<V>(a.plane, b.plane, p.weight)), u, v, a.texture, a.material});
      at.globals.store(p.sample, {global});
    }
    at.colours.store(p.sample, {global});
    at.surfaces.store(item, {item});
    at.points.store(item, {g.position, a.material, g.normal, 1.0F});
    at.paths.store(item, {{1.0F, 1.0F, 1.0F}, p.sample});
    at.mattes.store(item, {diffuse, a.classes});
    at.texcoords.store(item, {u, v, a.texture});
  }
};

// The identity word of a sample for post-correction: a hash of what it shows, and these flags. Reference samples have
// neither flag.
inline constexpr std::uint32_t kTracedSample = 1U << 31;
inline constexpr std::uint32_t kInterpolatedSample = 1U << 30;
inline constexpr std::uint32_t kIdentityMask = kInterpolatedSample - 1;

/// One scan of post-correction (Kim et al. 2016, section 4). An interpolated sample is suspect if a traced neighbour
/// has another identity. Samples of a line are `step` apart, lines `line_step`.
template <bool kEight>
struct FindSuspects {
  static constexpr std::string_view kName = kEight ? "find_suspects_8" : "find_suspects_4";
  static constexpr std::string_view kMeaning = kEight ? "sample, its three neighbours behind -> stream of suspects"
                                                      : "sample, its neighbour behind -> stream of suspects";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples, identities, suspects;
    Counter<V> suspect_count;
    I<V> step, line_step;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.identities));
      port(NAMED(p.suspects));
      port(NAMED(p.suspect_count));
      port(NAMED(p.step));
      port(NAMED(p.line_step));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    const I<V> own = at.identities.load(sample).word;
    const auto differs = [&](const I<V>& neighbour) {
      const I<V> other = at.identities.load(neighbour).word;
      const M<V> same = ((own ^ other) & kIdentityMask) == 0U;
      return select(same, I<V>(0U), other & kTracedSample);
    };
    I<V> traced = differs(sample - at.step);
    if constexpr (kEight) {
      traced = traced | differs(sample - at.step - at.line_step) | differs(sample - at.step + at.line_step);
    }
    const M<V> suspect = both(I<V>(0U) < traced, I<V>(0U) < (own & kInterpolatedSample));
    at.suspects.store(at.suspect_count.next(suspect), {sample});
  }
};

template <class V, bool kShadows>
I<V> shown_by(const GeometryRecord<V>& geometry) {
  I<V> shown = geometry.object;
  if constexpr (kShadows) shown = scrambled<V>(shown ^ scrambled<V>(geometry.shadows));
  return shown & kIdentityMask;
}

/// With kShadows the identity includes a sample's shadows.
template <bool kShadows>
struct StoreIdentities {
  static constexpr std::string_view kName = kShadows ? "store_identities_shadows" : "store_identities";
  static constexpr std::string_view kMeaning = "sample -> what it shows and how it came about, for post-correction";
  template <class V>
  struct Ports {
    Local<V, GeometryRecord> geometry;
    Local<V, WordRecord> verdicts, identities;
    LatticeUniforms<V> lattice;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.geometry));
      port(NAMED(p.verdicts));
      port(NAMED(p.identities));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = lattice_sample<V>(item, at.lattice);
    const GeometryRecord<V> geometry = at.geometry.load(sample);
    const I<V> verdict = at.verdicts.load(sample).word;
    const I<V> how = select(verdict == 0U, I<V>(kInterpolatedSample),
                            select(verdict == kReferenceVerdict, I<V>(0U), I<V>(kTracedSample)));
    at.identities.store(item, {shown_by<V, kShadows>(geometry) | how});
  }
};

}  // namespace kernels
