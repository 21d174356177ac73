#pragma once
#include <string_view>

#include "shader_kernels/kernels/average_colour.h"
#include "shader_kernels/kernels/sample_grid.h"

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
      port(p.width, "width");
      port(p.inverse_width, "inverse_width");
      port(p.grid, "grid");
      port(p.inverse_grid, "inverse_grid");
      port(p.first, "first");
      port(p.pitch, "pitch");
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const Split<V> pixel = split<V>(to_float(item), at.samples, at.inverse_samples);
    const Split<V> row = split<V>(pixel.quotient, at.width, at.inverse_width);
    const Split<V> cell = split<V>(pixel.remainder, at.grid, at.inverse_grid);
    const F<V> sample =
        at.first + (row.quotient * at.grid + cell.quotient) * at.pitch + row.remainder * at.grid + cell.remainder;
    AverageColour::add<V>(at, pixel, at.colours.load(to_int(sample)).rgb);
  }
};

}  // namespace kernels
