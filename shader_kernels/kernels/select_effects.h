#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

// Effects at a lower rate (docs/design/effects.md): one of 2 x 2 pixels has rays, or every other one as on a
// checkerboard. The others take the share of light that reaches them from those around.

/// Whether the pixel at (x, y) is one that has none.
template <class V, bool kCheckerboard>
I<V> is_left_out(const I<V>& x, const I<V>& y) {
  return (kCheckerboard ? x ^ y : x | y) & 1U;
}

/// The inspector. Samples of the tile buffer are pixels.
template <bool kCheckerboard>
struct SelectEffects {
  static constexpr std::string_view kName = kCheckerboard ? "select_effects_checkerboard" : "select_effects";
  static constexpr std::string_view kMeaning =
      kCheckerboard ? "diffuse surface -> stream of those of every other pixel, as on a checkerboard"
                    : "diffuse surface -> stream of those of one of 2 x 2 pixels";
  template <class V>
  struct Ports {
    Local<V, WordRecord> diffuse;
    Local<V, PathRecord> paths;
    Local<V, WordRecord> passed;
    Counter<V> passed_count;
    GridUniforms<V> grid;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.diffuse));
      port(NAMED(p.paths));
      port(NAMED(p.passed));
      port(NAMED(p.passed_count));
      GridUniforms<V>::describe(p.grid, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> slot = at.diffuse.load(item).word;
    const DivMod<V> pixel = divmod<V>(to_float(at.paths.load(slot).sample), at.grid.pitch, at.grid.inverse_pitch);
    const I<V> left_out = is_left_out<V, kCheckerboard>(to_int(at.grid.x0 + pixel.remainder),  //
                                                        to_int(at.grid.y0 + pixel.quotient));
    at.passed.store(at.passed_count.next(left_out == 0U), {slot});
  }
};

}  // namespace kernels
