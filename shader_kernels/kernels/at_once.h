#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Takes the place of a mask that holds for all items of a stream.
struct AllItems {};

/// A value where the mask holds, elsewhere nothing.
template <class V>
Vec3<V> where(AllItems, const Vec3<V>& value) {
  return value;
}
template <class V>
Vec3<V> where(const M<V>& mask, const Vec3<V>& value) {
  return select(mask, value, Vec3<V>{0.0F, 0.0F, 0.0F});
}
template <class V>
M<V> both_of(AllItems, const M<V>& other) {
  return other;
}
template <class V>
M<V> both_of(const M<V>& mask, const M<V>& other) {
  return both(mask, other);
}

/// Classes of a surface that add to its sample before or amid its local light, or change its base colour.
inline constexpr std::uint32_t kLaterClasses =
    traces::kTextured | traces::kEmissive | traces::kGlowing | traces::kOccluded;

/// Whether a surface can be lit as soon as it is known: its local light is the first that its sample gets of it.
template <class V>
M<V> is_lit_at_once(const I<V>& classes) {
  return (classes & (kLaterClasses | traces::kDiffuse)) == static_cast<std::uint32_t>(traces::kDiffuse);
}

/// Kernel K, which runs over the diffuse surfaces, over all surfaces instead: it acts on those that are lit at once.
template <class K>
struct AtOnce {
  using Of = K;
  template <class V>
  struct Ports : K::template Ports<V> {
    Local<V, WordRecord> surfaces;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      K::template Ports<V>::describe(p, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    K::template shade<V>(slot, is_lit_at_once<V>(at.mattes.load(slot).classes), at);
  }
};

/// Lists the diffuse surfaces that are not lit at once.
struct ListLater {
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, DiffuseRecord> mattes;
    Local<V, WordRecord> later;
    Counter<V> later_count;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(NAMED(p.mattes));
      port(NAMED(p.later));
      port(NAMED(p.later_count));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.surfaces.load(item).word;
    const I<V> classes = at.mattes.load(slot).classes;
    const M<V> is_later = both(has<V>(classes, traces::kDiffuse), I<V>(0U) < (classes & kLaterClasses));
    at.later.store(at.later_count.next(is_later), {slot});
  }
};

}  // namespace kernels
