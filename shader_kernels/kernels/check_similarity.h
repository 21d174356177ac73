#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/sample_neighbours.h"
#include "sim/named.h"

namespace kernels {

/// The inspector of multi-rate sampling (Lee et al. 2016): same object, similar normals, same shadows at the first hit
/// and, with kSecondary, at those behind mirrors and glass. With kTexture it compares the colours of textured surfaces,
/// too: against one distance as a check, against another to count samples that pass and yet are rough.
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
    Local<V, ColourRecord> colours;      ///< wired if kTexture, and what follows
    F<V> texture_squared, rate_squared;  ///< colours farther apart fail, or are rough
    Counter<V> rough_count;
    static void describe(auto& p, auto&& port) {
      VerdictPorts<V>::describe(p, port);
      port(NAMED(p.geometry));
      port(NAMED(p.secondary));
      port(NAMED(p.least_dot));
      if constexpr (kTexture) {
        port(NAMED(p.colours));
        port(NAMED(p.texture_squared));
        port(NAMED(p.rate_squared));
        port(NAMED(p.rough_count));
      }
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SampleNeighbours<V> b = sample_neighbours<kAlongY, V>(item, at.line);
    const GeometryRecord<V> before = at.geometry.load(b.before);
    const GeometryRecord<V> after = at.geometry.load(b.after);
    I<V> failed = select(before.object == after.object, I<V>(0U), I<V>(bit(Check::kObject))) |
                  fails_if<V>(dot(before.normal, after.normal) < at.least_dot, Check::kNormal) |
                  select(before.shadows == after.shadows, I<V>(0U), I<V>(bit(Check::kShadow)));
    if constexpr (kSecondary) {
      const SecondaryRecord<V> one = at.secondary.load(b.before);
      const SecondaryRecord<V> other = at.secondary.load(b.after);
      const F<V> least = min(dot(one.mirror_normal, other.mirror_normal), dot(one.glass_normal, other.glass_normal));
      failed = failed | select(one.objects == other.objects, I<V>(0U), I<V>(bit(Check::kSecondaryObject))) |
               fails_if<V>(least < at.least_dot, Check::kSecondaryNormal) |
               select(one.shadows == other.shadows, I<V>(0U), I<V>(bit(Check::kSecondaryShadow)));
    }
    if constexpr (kTexture) {
      const Vec3<V> one = at.colours.load(b.before).rgb;
      const Vec3<V> other = at.colours.load(b.after).rgb;
      const F<V> apart = encoded_distance_squared<V>(one, other);
      const M<V> textured = (before.object & kTexturedObject) == kTexturedObject;
      failed = failed | fails_if<V>(both(textured, at.texture_squared < apart), Check::kTexture);
      const M<V> rough = both(textured, at.rate_squared < apart);
      at.rough_count.next(both(rough, select(b.outside, I<V>(1U), failed) == 0U));
    }
    write_verdict<V>(at, b, failed);
  }
};

}  // namespace kernels
