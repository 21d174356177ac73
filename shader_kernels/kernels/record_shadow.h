#pragma once
#include <string_view>
#include <type_traits>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// One launch per light and bounce, behind combine_shadow. A light that a surface is turned away from casts no shadow
/// on it.
template <template <class> class R>
struct RecordShadowPorts {
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, R> records;
    I<V> mark;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.shadow_hits));
      port(NAMED(p.shadow_paths));
      port(NAMED(p.records));
      port(NAMED(p.mark));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const M<V> lit = at.shadow_hits.load(item).triangle == traces::kNoHit;
    const I<V> sample = at.shadow_paths.load(item).sample;
    R<V> record = at.records.load(sample);
    const I<V> mark = select(lit, I<V>(0U), at.mark);
    if constexpr (std::is_same_v<R<V>, GeometryRecord<V>> || std::is_same_v<R<V>, VisibleRecord<V>>) {
      record.shadows = record.shadows | mark;  // lights beyond 32 share bits
    } else {
      record.shadows = record.shadows + mark;
    }
    at.records.store(sample, record);
  }
};

struct RecordShadow : RecordShadowPorts<GeometryRecord> {
  static constexpr std::string_view kName = "record_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a first hit -> mark in its sample if it was stopped";
};

struct RecordSecondaryShadow : RecordShadowPorts<SecondaryRecord> {
  static constexpr std::string_view kName = "record_secondary_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a secondary hit -> mark in its sample if it was stopped";
};

struct RecordTraitsShadow : RecordShadowPorts<TraitsRecord> {
  static constexpr std::string_view kName = "record_traits_shadow";
  static constexpr std::string_view kMeaning = "shadow ray of a first hit -> counted in its sample if it was stopped";
};

struct RecordVisibleShadow : RecordShadowPorts<VisibleRecord> {
  static constexpr std::string_view kName = "record_visible_shadow";
  static constexpr std::string_view kMeaning =
      "shadow ray of a first hit, or of one behind it -> mark if it was stopped";
};

}  // namespace kernels
