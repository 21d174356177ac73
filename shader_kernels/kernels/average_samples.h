#pragma once
#include <string_view>

#include "shader_kernels/kernels/average_colour.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

/// As average_colour, of samples that lie row by row.
struct AverageSamples {
  static constexpr std::string_view kName = "average_samples";
  static constexpr std::string_view kMeaning = "sample of a grid -> mean of its pixel's samples, clamped, linear light";
  template <class V>
  struct Ports : AverageColour::Ports<V> {
    F<V> width, inverse_width;  ///< pixels in a row of the tile
    F<V> grid, inverse_grid;
    F<V> first, pitch;
    static void describe(auto& p, auto&& port) {
      AverageColour::Ports<V>::describe(p, port);
      port(NAMED(p.width));
      port(NAMED(p.inverse_width));
      port(NAMED(p.grid));
      port(NAMED(p.inverse_grid));
      port(NAMED(p.first));
      port(NAMED(p.pitch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = divmod<V>(to_float(item), at.samples, at.inverse_samples);
    const DivMod<V> row = divmod<V>(pixel.quotient, at.width, at.inverse_width);
    const DivMod<V> cell = divmod<V>(pixel.remainder, at.grid, at.inverse_grid);
    const F<V> sample =
        at.first + (row.quotient * at.grid + cell.quotient) * at.pitch + row.remainder * at.grid + cell.remainder;
    AverageColour::add<V>(at, pixel, at.colours.load(to_int(sample)).rgb);
  }
};

}  // namespace kernels
