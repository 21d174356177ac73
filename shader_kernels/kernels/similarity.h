#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/uniforms.h"
#include "sim/named.h"
#include "traces/accel/memory_image.h"

namespace kernels {

/// Similarity checks between the two reference samples around a sample. A kernel stores the failed checks as bits in
/// the tile buffer; 0 means that all passed. The checks are in the order of the papers (Kim et al. 2016, Lee et al.
/// 2016). The first failed check is reported as the reason why a sample is traced.
enum class Check : std::uint8_t {
  kObject,
  kPosition,
  kNormal,
  kConvexity,
  kTexture,
  kShadow,
  kColour,
  kSecondaryObject,
  kSecondaryNormal,
  kSecondaryShadow,
  kDetail,  ///< fails if the surface cannot be shaded from interpolated attributes
  kBorder,  ///< fails if a reference sample is outside the picture
  kCount
};
constexpr std::array<std::string_view, 12> names_of(Check) {
  return {"object", "position",         "normal",           "convexity",        "texture", "shadow",
          "colour", "secondary_object", "secondary_normal", "secondary_shadow", "detail",  "border"};
}
constexpr std::uint32_t check_bit(Check check) { return 1U << static_cast<std::uint32_t>(check); }

/// Samples on parallel lines: every `block`-th sample is a reference, the others are to be interpolated. A line starts
/// with a reference at position 0; positions below `low` or above `high` are outside the picture. `gaps` is block - 1.
template <class V>
struct LineUniforms {
  F<V> inner, inverse_inner;  ///< along x: interpolated samples per line; along y: number of lines
  F<V> gaps, inverse_gaps, block, inverse_block;
  F<V> first, step, line_step;  ///< index of the first sample; index steps between positions and between lines
  F<V> low, high;
  static constexpr void describe(auto& line, auto&& port) {
    port(line.inner, "line.inner");
    port(line.inverse_inner, "line.inverse_inner");
    port(line.gaps, "line.gaps");
    port(line.inverse_gaps, "line.inverse_gaps");
    port(line.block, "line.block");
    port(line.inverse_block, "line.inverse_block");
    port(line.first, "line.first");
    port(line.step, "line.step");
    port(line.line_step, "line.line_step");
    port(line.low, "line.low");
    port(line.high, "line.high");
  }
};

/// A sample and the two reference samples around it.
template <class V>
struct SampleNeighbours {
  I<V> sample, before, after;
  I<V> gap;      ///< position of the sample between its two references, counted from 0
  M<V> outside;  ///< a reference is outside the picture
};

/// Returns the sample that item `item` checks, with its two references. Along x, consecutive items are in one line;
/// along y, they are in neighbouring lines.
template <bool kAlongY, class V>
SampleNeighbours<V> sample_neighbours(const I<V>& item, const LineUniforms<V>& line) {
  const DivMod<V> outer = div_mod<V>(to_float(item), line.inner, line.inverse_inner);
  const F<V> number = kAlongY ? outer.quotient : outer.remainder;
  const F<V> of_line = kAlongY ? outer.remainder : outer.quotient;
  const DivMod<V> gap = div_mod<V>(number, line.gaps, line.inverse_gaps);
  const F<V> position = gap.quotient * line.block;
  const F<V> before = line.first + of_line * line.line_step + position * line.step;
  return {to_int(before + (gap.remainder + 1.0F) * line.step), to_int(before), to_int(before + line.block * line.step),
          to_int(gap.remainder), logical_or(position < line.low, line.high < position + line.block)};
}

// Layout of an entry in the list of passed samples: sample index in the low bits, SampleNeighbours::gap above.
inline constexpr std::uint32_t kGapShift = 24;
inline constexpr std::uint32_t kSampleMask = (1U << kGapShift) - 1;

template <class V>
struct PassedSample {
  I<V> sample, before, after;
  F<V> weight;  ///< interpolation weight of sample `after`; sample `before` has 1 minus this weight
};
template <class V>
PassedSample<V> unpack_passed_sample(const I<V>& word, const LineUniforms<V>& line) {
  const I<V> sample = word & kSampleMask;
  const F<V> steps = to_float(word >> kGapShift) + 1.0F;
  const F<V> own = to_float(sample);
  const F<V> before = own - steps * line.step;
  return {sample, to_int(before), to_int(before + line.block * line.step), steps * line.inverse_block};
}

/// Runs interpolation kernel K over all samples instead of the list of those that passed. Samples that failed are
/// traced afterwards, and tracing overwrites their interpolated values.
template <bool kAlongY, class K>
struct InterpolateAll {
  using Of = K;
  template <class V>
  using Ports = typename K::template Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, io.line);
    K::template interpolate<V>({b.sample, b.before, b.after, (to_float(b.gap) + 1.0F) * io.line.inverse_block}, io);
  }
};

/// Ports of kernels that check samples for similarity. They store each sample's failed checks in `verdicts`, and append
/// the sample to the list of those that passed or to that of those that failed.
template <class V>
struct VerdictPorts {
  LineUniforms<V> line;
  Local<V, WordRecord> verdicts, passed, failed;
  Counter<V> passed_count, failed_count;
  static constexpr void describe(auto& p, auto&& port) {
    LineUniforms<V>::describe(p.line, port);
    name_all(port, NAMED_ALL(p.verdicts, p.passed, p.failed, p.passed_count, p.failed_count));
  }
};
template <class V>
void write_verdict(VerdictPorts<V>& io, const SampleNeighbours<V>& neighbours, const I<V>& failed_checks) {
  const I<V> failed = select(neighbours.outside, I<V>(check_bit(Check::kBorder)), failed_checks);
  io.verdicts.store(neighbours.sample, {failed});
  io.passed.store(io.passed_count.next_index(failed == 0U), {neighbours.sample | (neighbours.gap << kGapShift)});
  io.failed.store(io.failed_count.next_index(I<V>(0U) < failed), {neighbours.sample});
}

template <class V>
I<V> check_bit_if(const M<V>& mask, Check check) {
  return select(mask, I<V>(check_bit(check)), I<V>(0U));
}

template <class V>
F<V> lerp(const F<V>& a, const F<V>& b, const F<V>& weight) {
  return a + (b - a) * weight;
}
template <class V>
Vec3<V> lerp(const Vec3<V>& a, const Vec3<V>& b, const F<V>& weight) {
  return a + (b - a) * weight;
}

/// Interpolates two colours. Each colour is clamped to [0, 1] first, because pixels average clamped samples.
template <class V>
Vec3<V> lerp_colours(const Vec3<V>& a, const Vec3<V>& b, const F<V>& weight) {
  return lerp<V>({clamp_to_unit<V>(a.x), clamp_to_unit<V>(a.y), clamp_to_unit<V>(a.z)},
                 {clamp_to_unit<V>(b.x), clamp_to_unit<V>(b.y), clamp_to_unit<V>(b.z)}, weight);
}

/// Checks samples for the program multirate (Lee et al. 2016): both references must have the same object, similar
/// normals and the same shadows at the first hit, with kSecondary also at mirrored and refracted hits. With kTexture
/// the colours of textured surfaces must be similar. Samples that pass, but whose colours differ by more than a second,
/// smaller threshold, are counted as rough.
template <bool kAlongY, bool kSecondary, bool kTexture>
struct CheckSimilarity {
  static constexpr std::array<std::string_view, 8> kNames{"check_similarity_x",
                                                          "check_similarity_y",
                                                          "check_similarity_x_secondary",
                                                          "check_similarity_y_secondary",
                                                          "check_similarity_x_texture",
                                                          "check_similarity_y_texture",
                                                          "check_similarity_x_secondary_texture",
                                                          "check_similarity_y_secondary_texture"};
  static constexpr std::string_view kName = kNames[(kAlongY ? 1 : 0) + (kSecondary ? 2 : 0) + (kTexture ? 4 : 0)];
  static constexpr std::string_view kMeaning = "sample between two traced ones -> stream passed or failed";
  template <class V>
  struct Ports : VerdictPorts<V> {
    Local<V, GeometryRecord> geometry;
    Local<V, SecondaryRecord> secondary;
    F<V> least_dot;
    Local<V, ColourRecord> colours;      ///< colours of samples; like the next two ports only in kTexture variants
    F<V> texture_squared, rate_squared;  ///< squared colour distances above which a sample fails, or counts as rough
    Counter<V> rough_count;
    static constexpr void describe(auto& p, auto&& port) {
      VerdictPorts<V>::describe(p, port);
      name_all(port, NAMED_ALL(p.geometry, p.secondary, p.least_dot));
      if constexpr (kTexture) {
        name_all(port, NAMED_ALL(p.colours, p.texture_squared, p.rate_squared, p.rough_count));
      }
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, io.line);
    const GeometryRecord<V> before = io.geometry.load(b.before);
    const GeometryRecord<V> after = io.geometry.load(b.after);
    I<V> failed = select(before.object == after.object, I<V>(0U), I<V>(check_bit(Check::kObject))) |
                  check_bit_if<V>(dot(before.normal, after.normal) < io.least_dot, Check::kNormal) |
                  select(before.shadows == after.shadows, I<V>(0U), I<V>(check_bit(Check::kShadow)));
    if constexpr (kSecondary) {
      const SecondaryRecord<V> one = io.secondary.load(b.before);
      const SecondaryRecord<V> other = io.secondary.load(b.after);
      const F<V> least = min(dot(one.mirror_normal, other.mirror_normal), dot(one.glass_normal, other.glass_normal));
      failed = failed | select(one.objects == other.objects, I<V>(0U), I<V>(check_bit(Check::kSecondaryObject))) |
               check_bit_if<V>(least < io.least_dot, Check::kSecondaryNormal) |
               select(one.shadows == other.shadows, I<V>(0U), I<V>(check_bit(Check::kSecondaryShadow)));
    }
    if constexpr (kTexture) {
      const Vec3<V> one = io.colours.load(b.before).rgb;
      const Vec3<V> other = io.colours.load(b.after).rgb;
      const F<V> apart = encoded_distance_squared<V>(one, other);
      const M<V> textured = (before.object & kTexturedObject) == kTexturedObject;
      failed = failed | check_bit_if<V>(logical_and(textured, io.texture_squared < apart), Check::kTexture);
      const M<V> rough = logical_and(textured, io.rate_squared < apart);
      io.rough_count.next_index(logical_and(rough, select(b.outside, I<V>(1U), failed) == 0U));
    }
    write_verdict<V>(io, b, failed);
  }
};

/// Interpolates the geometry record of a sample. The sample then becomes a reference for the checks along the other
/// axis. Attributes are copied if the checks require them to be equal.
template <class V>
GeometryRecord<V> lerp_geometry(const GeometryRecord<V>& a, const GeometryRecord<V>& b, const F<V>& weight) {
  return {unit_vector(lerp<V>(a.normal, b.normal, weight)), a.object, lerp<V>(a.position, b.position, weight),
          a.shadows};
}

/// Interpolates the colours of samples that passed the checks of the program multirate (Lee et al. 2016). Along x it
/// also stores the geometry for the checks along y.
template <bool kAlongY, bool kSecondary>
struct InterpolateSample {
  static constexpr std::string_view kName =
      kAlongY ? "interpolate_y" : (kSecondary ? "interpolate_x_secondary" : "interpolate_x");
  static constexpr std::string_view kMeaning = "sample that passed -> colour between its references";
  template <class V>
  struct Ports {
    Local<V, WordRecord> passed;
    LineUniforms<V> line;
    Local<V, ColourRecord> colours;
    Local<V, GeometryRecord> geometry;
    Local<V, SecondaryRecord> secondary;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.passed));
      LineUniforms<V>::describe(p.line, port);
      name_all(port, NAMED_ALL(p.colours, p.geometry, p.secondary));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    interpolate<V>(unpack_passed_sample<V>(io.passed.load(item).word, io.line), io);
  }
  template <class V>
  static void interpolate(const PassedSample<V>& p, const Ports<V>& io) {
    io.colours.store(p.sample,
                     {lerp_colours<V>(io.colours.load(p.before).rgb, io.colours.load(p.after).rgb, p.weight)});
    if constexpr (!kAlongY) {
      io.geometry.store(p.sample, lerp_geometry<V>(io.geometry.load(p.before), io.geometry.load(p.after), p.weight));
    }
    if constexpr (kSecondary) {
      const SecondaryRecord<V> a = io.secondary.load(p.before);
      const SecondaryRecord<V> b = io.secondary.load(p.after);
      io.secondary.store(p.sample, {unit_vector(lerp<V>(a.mirror_normal, b.mirror_normal, p.weight)), a.objects,
                                    unit_vector(lerp<V>(a.glass_normal, b.glass_normal, p.weight)), a.shadows});
    }
  }
};

/// True if two texture coordinates are on opposite sides of a texture's border: the fraction of one coordinate is below
/// the threshold, that of the other is above 1 minus the threshold.
template <class V>
M<V> crosses_texture_border(const F<V>& a, const F<V>& b, const F<V>& threshold) {
  const F<V> x = a - floor(a);
  const F<V> y = b - floor(b);
  return logical_and(min(x, y) < threshold, 1.0F - threshold < max(x, y));
}

/// Checks samples for the program undersample: the seven similarity checks of Kim et al. 2016, table 1.
///
/// 1. The convexity check has a slack of 0.001 squared distances, because rounding would fail coplanar pairs.
/// 2. Base and occlusion textures are read at the interpolated coordinates. Second coordinates are not stored, so a
/// surface whose occlusion texture needs them is traced.
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
      name_all(port,
               NAMED_ALL(p.geometry, p.kept, p.globals, p.apart_squared, p.least_dot, p.texture, p.colour_squared));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, io.line);
    const GeometryRecord<V> g0 = io.geometry.load(b.before);
    const GeometryRecord<V> g1 = io.geometry.load(b.after);
    const SurfaceRecord<V> s0 = io.kept.load(b.before);
    const SurfaceRecord<V> s1 = io.kept.load(b.after);
    const Vec3<V> d = g1.position - g0.position;
    const F<V> squared = dot(d, d);
    const F<V> bend = dot(d, s0.plane) * -dot(d, s1.plane);
    I<V> failed = select(g0.object == g1.object, I<V>(0U), I<V>(check_bit(Check::kObject))) |
                  check_bit_if<V>(io.apart_squared < squared, Check::kPosition) |
                  check_bit_if<V>(dot(g0.normal, g1.normal) < io.least_dot, Check::kNormal) |
                  check_bit_if<V>(bend < squared * -1e-6F, Check::kConvexity) |
                  select(g0.shadows == g1.shadows, I<V>(0U), I<V>(check_bit(Check::kShadow)));
    if constexpr (kColours) {
      const F<V> colours = encoded_distance_squared<V>(io.globals.load(b.before).rgb, io.globals.load(b.after).rgb);
      failed = failed | check_bit_if<V>(io.colour_squared < colours, Check::kColour);
    }
    if constexpr (kTextures) {
      const M<V> over_edge = logical_or(crosses_texture_border<V>(s0.u, s1.u, io.texture),
                                        crosses_texture_border<V>(s0.v, s1.v, io.texture));
      const M<V> has_any = I<V>(0U) < (s0.classes & (traces::kTextured | traces::kOccluded));
      constexpr std::uint32_t kUnkept = traces::kOccluded | traces::kOcclusionSecond;
      failed = failed | check_bit_if<V>(logical_and(over_edge, has_any), Check::kTexture) |
               select((s0.classes & kUnkept) == kUnkept, I<V>(check_bit(Check::kDetail)), I<V>(0U));
    }
    write_verdict<V>(io, b, failed);
  }
};

/// Interpolates the attributes of samples that passed the checks of the program undersample (Kim et al. 2016), to be
/// shaded next. Along x it also stores them for the checks along y.
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
      name_all(port, NAMED_ALL(p.geometry, p.kept, p.globals, p.colours, p.surfaces));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.mattes, p.texcoords));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PassedSample<V> p = unpack_passed_sample<V>(io.passed.load(item).word, io.line);
    const GeometryRecord<V> g = lerp_geometry<V>(io.geometry.load(p.before), io.geometry.load(p.after), p.weight);
    const SurfaceRecord<V> a = io.kept.load(p.before);
    const SurfaceRecord<V> b = io.kept.load(p.after);
    const Vec3<V> diffuse = lerp<V>(a.diffuse, b.diffuse, p.weight);
    const F<V> u = lerp<V>(a.u, b.u, p.weight);
    const F<V> v = lerp<V>(a.v, b.v, p.weight);
    const Vec3<V> global = lerp<V>(io.globals.load(p.before).rgb, io.globals.load(p.after).rgb, p.weight);
    io.geometry.store(p.sample, g);
    if constexpr (!kAlongY) {
      io.kept.store(p.sample, {diffuse, a.classes, unit_vector(lerp<V>(a.plane, b.plane, p.weight)), u, v, a.texture,
                               a.material});
      io.globals.store(p.sample, {global});
    }
    io.colours.store(p.sample, {global});
    io.surfaces.store(item, {item});
    io.points.store(item, {g.position, a.material, g.normal, 1.0F});
    io.paths.store(item, {{1.0F, 1.0F, 1.0F}, p.sample});
    io.mattes.store(item, {diffuse, a.classes});
    io.texcoords.store(item, {u, v, a.texture});
  }
};

// Flags of a sample's identity word in post-correction; the other bits hash what the sample shows. References have
// neither flag.
inline constexpr std::uint32_t kTracedSample = 1U << 31;
inline constexpr std::uint32_t kInterpolatedSample = 1U << 30;
inline constexpr std::uint32_t kIdentityMask = kInterpolatedSample - 1;

/// One pass of post-correction (Kim et al. 2016, section 4). An interpolated sample is listed for tracing if a traced
/// neighbour has another identity word. Indices differ by `step` between samples of a line, and by `line_step` between
/// lines.
template <bool kEight>
struct FindSuspects {
  static constexpr std::string_view kName = kEight ? "find_suspects_8" : "find_suspects_4";
  static constexpr std::string_view kMeaning = kEight ? "sample, its three earlier neighbours -> stream of suspects"
                                                      : "sample, its neighbour behind -> stream of suspects";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples, identities, suspects;
    Counter<V> suspect_count;
    I<V> step, line_step;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.identities, p.suspects, p.suspect_count, p.step, p.line_step));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.samples.load(item).word;
    const I<V> own = io.identities.load(sample).word;
    const auto differs = [&](const I<V>& neighbour) {
      const I<V> other = io.identities.load(neighbour).word;
      const M<V> same = ((own ^ other) & kIdentityMask) == 0U;
      return select(same, I<V>(0U), other & kTracedSample);
    };
    I<V> traced = differs(sample - io.step);
    if constexpr (kEight) {
      traced = traced | differs(sample - io.step - io.line_step) | differs(sample - io.step + io.line_step);
    }
    const M<V> suspect = logical_and(I<V>(0U) < traced, I<V>(0U) < (own & kInterpolatedSample));
    io.suspects.store(io.suspect_count.next_index(suspect), {sample});
  }
};

template <class V, bool kShadows>
I<V> identity_bits(const GeometryRecord<V>& geometry) {
  I<V> shown = geometry.object;
  if constexpr (kShadows) shown = scramble_bits<V>(shown ^ scramble_bits<V>(geometry.shadows));
  return shown & kIdentityMask;
}

/// Stores the identity words of samples for post-correction. With kShadows the identity includes a sample's shadows.
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
      name_all(port, NAMED_ALL(p.geometry, p.verdicts, p.identities));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = lattice_sample<V>(item, io.lattice);
    const GeometryRecord<V> geometry = io.geometry.load(sample);
    const I<V> verdict = io.verdicts.load(sample).word;
    const I<V> how = select(verdict == 0U, I<V>(kInterpolatedSample),
                            select(verdict == kReferenceVerdict, I<V>(0U), I<V>(kTracedSample)));
    io.identities.store(item, {identity_bits<V, kShadows>(geometry) | how});
  }
};

}  // namespace kernels
