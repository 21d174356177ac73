#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_grid.h"

namespace kernels {

struct ListSamples {
  static constexpr std::string_view kName = "list_samples";
  static constexpr std::string_view kMeaning = "number -> sample of a regular lattice";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    LatticeUniforms<V> lattice;
    static void describe(auto& p, auto&& port) {
      port(p.samples, "samples");
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Split<V> row = split<V>(to_float(item), at.lattice.across, at.lattice.inverse_across);
    at.samples.store(item,
                     {to_int(at.lattice.first + row.remainder * at.lattice.step + row.quotient * at.lattice.row_step)});
  }
};

}  // namespace kernels
