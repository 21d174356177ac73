#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

// A sample's word for post-correction: a hash of what it shows, and how it came about. Reference samples have
// neither bit.
inline constexpr std::uint32_t kTracedSample = 1U << 31;
inline constexpr std::uint32_t kInterpolatedSample = 1U << 30;
inline constexpr std::uint32_t kIdentityMask = kInterpolatedSample - 1;

/// Post-correction (Kim et al. 2016, section 4), one scan: an interpolated sample beside a traced one that shows
/// something else may have missed it. Samples of a line lie `step` apart, lines `line_step`.
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
    static void describe(auto& p, auto&& port) {
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

/// With kShadows, samples with other shadows show something else.
template <bool kShadows>
struct StoreIdentities {
  static constexpr std::string_view kName = kShadows ? "store_identities_shadows" : "store_identities";
  static constexpr std::string_view kMeaning = "sample -> what it shows and how it came about, for post-correction";
  template <class V>
  struct Ports {
    Local<V, GeometryRecord> geometry;
    Local<V, WordRecord> verdicts, identities;
    LatticeUniforms<V> lattice;
    static void describe(auto& p, auto&& port) {
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
