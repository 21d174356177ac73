#pragma once
#include <string_view>

#include "shader_kernels/kernels/sample_grid.h"

namespace kernels {

/// Colours as they are compared: sRGB-encoded.
struct EncodeColours {
  static constexpr std::string_view kName = "encode_colours";
  static constexpr std::string_view kMeaning = "sample of a lattice -> its colour, clamped, sRGB-encoded";
  template <class V>
  struct Ports {
    LatticeUniforms<V> lattice;
    Local<V, ColourRecord> colours, references;
    static void describe(auto& p, auto&& port) {
      LatticeUniforms<V>::describe(p.lattice, port);
      port(p.colours, "colours");
      port(p.references, "references");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = lattice_sample<V>(item, at.lattice);
    const Vec3<V> colour = at.colours.load(sample).rgb;
    at.references.store(sample, {{encoded<V>(clamped<V>(colour.x)), encoded<V>(clamped<V>(colour.y)),
                                  encoded<V>(clamped<V>(colour.z))}});
  }
};

}  // namespace kernels
