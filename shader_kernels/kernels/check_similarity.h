#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_neighbours.h"
#include "sim/named.h"

namespace kernels {

/// The inspector of multi-rate sampling (Lee et al. 2016): same object, similar normals, same shadows at the first hit
/// and, with kSecondary, at those behind mirrors and glass.
template <bool kAlongY, bool kSecondary>
struct CheckSimilarity {
  static constexpr std::string_view kName = kAlongY
                                                ? (kSecondary ? "check_similarity_y_secondary" : "check_similarity_y")
                                                : (kSecondary ? "check_similarity_x_secondary" : "check_similarity_x");
  static constexpr std::string_view kMeaning = "sample between two traced ones -> stream passed or failed";
  template <class V>
  struct Ports : VerdictPorts<V> {
    Local<V, GeometryRecord> geometry;
    Local<V, SecondaryRecord> secondary;
    F<V> least_dot;
    static void describe(auto& p, auto&& port) {
      VerdictPorts<V>::describe(p, port);
      port(NAMED(p.geometry));
      port(NAMED(p.secondary));
      port(NAMED(p.least_dot));
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
    write_verdict<V>(at, b, failed);
  }
};

}  // namespace kernels
