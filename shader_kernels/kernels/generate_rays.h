#pragma once
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

template <class V>
struct GeneratePorts {
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, ColourRecord> colours;
  CameraUniforms<V> camera;
  TileUniforms<V> tile;
  I<V> image_width, seed;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.rays));
    port(NAMED(p.paths));
    port(NAMED(p.colours));
    CameraUniforms<V>::describe(p.camera, port);
    TileUniforms<V>::describe(p.tile, port);
    port(NAMED(p.image_width));
    port(NAMED(p.seed));
  }
};

/// The pixel of a sample, and its cell there.
template <class V>
struct SamplePosition {
  F<V> x, y;         ///< pixel
  F<V> column, row;  ///< cell of the pixel's grid
  F<V> number;       ///< the same as one number
};
template <class V>
SamplePosition<V> sample_position(const I<V>& item, const TileUniforms<V>& tile) {
  const DivMod<V> pixel = divmod<V>(to_float(item), tile.samples, tile.inverse_samples);
  const DivMod<V> row = divmod<V>(pixel.quotient, tile.width, tile.inverse_width);
  const DivMod<V> cell = divmod<V>(pixel.remainder, tile.grid, tile.inverse_grid);
  return {tile.x0 + row.remainder, tile.y0 + row.quotient, cell.remainder, cell.quotient, pixel.remainder};
}

/// The ray of `sample` through the picture's point (x, y), into slot `item`.
template <class V>
void emit_primary(const I<V>& item, const I<V>& sample, const F<V>& x, const F<V>& y, const auto& at) {
  const Vec3<V> direction = normalised(at.camera.corner + at.camera.right * x + at.camera.down * y);
  at.rays.store(item, {at.camera.origin, 0.0F, direction, std::numeric_limits<float>::infinity()});
  at.paths.store(item, {{1.0F, 1.0F, 1.0F}, sample});
  at.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
}

struct GenerateRays {
  static constexpr std::string_view kName = "generate_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples at the centres of a regular grid";
  template <class V>
  using Ports = GeneratePorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SamplePosition<V> s = sample_position<V>(item, at.tile);
    emit_primary<V>(item, item, s.x + (s.column + 0.5F) * at.tile.inverse_grid,
                    s.y + (s.row + 0.5F) * at.tile.inverse_grid, at);
  }
};

/// A random point within a cell, which depends on frame (seed), pixel and cell alone.
template <class V>
struct Jitter {
  F<V> x, y;
};
template <class V>
Jitter<V> jitter(const I<V>& pixel, const I<V>& cell, const I<V>& seed) {
  const I<V> hash_x = scrambled<V>(scrambled<V>(pixel ^ seed) + cell);
  const I<V> hash_y = scrambled<V>(hash_x ^ 0x9e3779b9U);
  return {unit_float<V>(hash_x), unit_float<V>(hash_y)};
}

struct GenerateJitteredRays {
  static constexpr std::string_view kName = "generate_jittered_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples anywhere in the cells of a grid";
  template <class V>
  using Ports = GeneratePorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const SamplePosition<V> s = sample_position<V>(item, at.tile);
    const I<V> pixel = to_int(s.y) * at.image_width + to_int(s.x);
    const Jitter<V> in_cell = jitter<V>(pixel, to_int(s.number), at.seed);
    emit_primary<V>(item, item, s.x + (s.column + in_cell.x) * at.tile.inverse_grid,
                    s.y + (s.row + in_cell.y) * at.tile.inverse_grid, at);
  }
};

}  // namespace kernels
