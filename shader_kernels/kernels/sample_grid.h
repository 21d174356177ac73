#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// A tile's samples as they lie in the tile buffer: row by row, `pitch` to a row, with what it needs of its neighbours
/// around its own. The picture's samples form one grid, `grid` x `grid` to a pixel.
template <class V>
struct GridUniforms {
  F<V> x0, y0;  ///< position of the first sample in the picture's grid
  F<V> pitch, inverse_pitch;
  F<V> grid, inverse_grid;
  static void describe(auto& g, auto&& port) {
    port(g.x0, "grid.x0");
    port(g.y0, "grid.y0");
    port(g.pitch, "grid.pitch");
    port(g.inverse_pitch, "grid.inverse_pitch");
    port(g.grid, "grid.grid");
    port(g.inverse_grid, "grid.inverse_grid");
  }
};

/// A lattice of samples: `across` to a row, steps in samples.
template <class V>
struct LatticeUniforms {
  F<V> first, across, inverse_across, step, row_step;
  static void describe(auto& l, auto&& port) {
    port(l.first, "lattice.first");
    port(l.across, "lattice.across");
    port(l.inverse_across, "lattice.inverse_across");
    port(l.step, "lattice.step");
    port(l.row_step, "lattice.row_step");
  }
};
template <class V>
I<V> lattice_sample(const I<V>& number, const LatticeUniforms<V>& lattice) {
  const DivMod<V> row = divmod<V>(to_float(number), lattice.across, lattice.inverse_across);
  return to_int(lattice.first + row.remainder * lattice.step + row.quotient * lattice.row_step);
}

/// Stands for failed checks at a reference sample, which is not checked.
inline constexpr std::uint32_t kReferenceVerdict = 1U << 31;

}  // namespace kernels
