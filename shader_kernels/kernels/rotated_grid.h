#pragma once
#include <string_view>

#include "shader_kernels/kernels/generate_rays.h"
#include "sim/named.h"

namespace kernels {

/// Samples of reconstruct in a pixel, and the side of the grid that they lie on.
inline constexpr std::uint32_t kGeometrySamples = 4;

/// Sample k of four on a rotated grid has row k of 4 x 4 cells, and a column that no other has: (2 k + 1) mod 5.
template <class V>
F<V> rotated_column(const F<V>& k) {
  const F<V> column = k + k + 1.0F;
  return column - select(F<V>(4.0F) < column, F<V>(5.0F), F<V>(0.0F));
}

/// Sample k of n x n has row k of n^2 x n^2 cells and column n (k + 1) mod (n^2 + 1) - 1: each row and each
/// column has one. Of four they are those of reconstruct; a lone one is in the middle.
struct GenerateRotatedRays {
  static constexpr std::string_view kName = "generate_rotated_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples on a rotated grid";
  template <class V>
  struct Ports : GeneratePorts<V> {
    F<V> cycle, inverse_cycle;  ///< n^2 + 1
    static void describe(auto& p, auto&& port) {
      GeneratePorts<V>::describe(p, port);
      port(NAMED(p.cycle));
      port(NAMED(p.inverse_cycle));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = divmod<V>(to_float(item), at.tile.samples, at.tile.inverse_samples);
    const DivMod<V> row = divmod<V>(pixel.quotient, at.tile.width, at.tile.inverse_width);
    const F<V> number = pixel.remainder;
    const DivMod<V> column = divmod<V>((number + 1.0F) * at.tile.grid, at.cycle, at.inverse_cycle);
    emit_primary<V>(item, item, at.tile.x0 + row.remainder + (column.remainder - 0.5F) * at.tile.inverse_samples,
                    at.tile.y0 + row.quotient + (number + 0.5F) * at.tile.inverse_samples, at);
  }
};

}  // namespace kernels
