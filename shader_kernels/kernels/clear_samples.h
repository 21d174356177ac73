#pragma once
#include <string_view>

#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Sets records of samples about to be traced to those of a miss.
struct ClearGeometry {
  static constexpr std::string_view kName = "clear_geometry";
  static constexpr std::string_view kMeaning = "sample -> its geometry is that of a miss";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, GeometryRecord> geometry;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.geometry));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.geometry.store(at.samples.load(item).word, {{0.0F, 0.0F, 1.0F}, kNoObject, {0.0F, 0.0F, 0.0F}, 0U});
  }
};

struct ClearSecondary {
  static constexpr std::string_view kName = "clear_secondary";
  static constexpr std::string_view kMeaning = "sample -> no secondary hits";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, SecondaryRecord> secondary;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.secondary));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    at.secondary.store(at.samples.load(item).word, {{0.0F, 0.0F, 1.0F}, 0U, {0.0F, 0.0F, 1.0F}, 0U});
  }
};

struct ClearTraits {
  static constexpr std::string_view kName = "clear_traits";
  static constexpr std::string_view kMeaning = "sample -> its traits are those of a miss, without a secondary hit";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, TraitsRecord> traits, secondary;
    Local<V, BranchRecord> branches;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.traits));
      port(NAMED(p.secondary));
      port(NAMED(p.branches));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    at.traits.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, 0U});
    at.secondary.store(sample, {{0.0F, 0.0F, 1.0F}, kNoObject, 0U});
    at.branches.store(sample, {0.0F, 0.0F});
  }
};

}  // namespace kernels
