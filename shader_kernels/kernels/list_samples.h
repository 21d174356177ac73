#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

/// References of a tile.
struct ListSamples {
  static constexpr std::string_view kName = "list_samples";
  static constexpr std::string_view kMeaning = "number -> reference sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples, verdicts;
    LatticeUniforms<V> lattice;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.verdicts));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = lattice_sample<V>(item, at.lattice);
    at.samples.store(item, {sample});
    at.verdicts.store(sample, {kReferenceVerdict});
  }
};

}  // namespace kernels
