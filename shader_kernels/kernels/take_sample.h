#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// As average_colour, of pixels that have one sample each.
struct TakeSample {
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours, pixels;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    take<V>(item, item, at);
  }
  template <class V>
  static void take(const I<V>& pixel, const I<V>& sample, const Ports<V>& at) {
    const Vec3<V> colour = at.colours.load(sample).rgb;
    at.pixels.store(pixel, {{clamped<V>(colour.x), clamped<V>(colour.y), clamped<V>(colour.z)}});
  }
};

/// As average_samples, of pixels that have one sample each.
struct TakeGridSample {
  template <class V>
  struct Ports : TakeSample::Ports<V> {
    LatticeUniforms<V> lattice;  ///< samples of the tile's pixels
    static void describe(auto& p, auto&& port) {
      TakeSample::Ports<V>::describe(p, port);
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    TakeSample::take<V>(item, lattice_sample<V>(item, at.lattice), at);
  }
};

}  // namespace kernels
