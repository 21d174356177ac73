#pragma once
#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/ports.h"
#include "shader_kernels/value.h"

namespace kernels {

/// A pinhole camera. The ray through picture position (x, y), in pixels from the top left, is corner + x * right + y *
/// down.
template <class V>
struct CameraUniforms {
  Vec3<V> origin, corner, right, down;
  static constexpr void describe(auto& c, auto&& port) {
    port(c.origin, "camera.origin");
    port(c.corner, "camera.corner");
    port(c.right, "camera.right");
    port(c.down, "camera.down");
  }
};

/// Ray cones (Akenine-Moeller et al. 2021). A cone is as wide as a sample in the picture plane and widens with distance
/// from the eye.
template <class V>
struct ConeUniforms {
  Vec3<V> eye;
  F<V> spread;  ///< width of the cone per unit of distance
  static constexpr void describe(auto& c, auto&& port) {
    port(c.eye, "cone.eye");
    port(c.spread, "cone.spread");
  }
};

/// Uniforms that describe the samples of a tile. A kernel's items are the samples of a pixel one after the other,
/// pixels row by row. The reciprocals (`inverse_...`) replace divisions in kernels.
template <class V>
struct TileUniforms {
  F<V> x0, y0;                    ///< picture position of the tile's first pixel
  F<V> width, inverse_width;      ///< pixels per row of the tile
  F<V> samples, inverse_samples;  ///< samples per pixel, `grid` squared
  F<V> grid, inverse_grid;        ///< samples along the side of a pixel
  static constexpr void describe(auto& c, auto&& port) {
    port(c.x0, "tile.x0");
    port(c.y0, "tile.y0");
    port(c.width, "tile.width");
    port(c.inverse_width, "tile.inverse_width");
    port(c.samples, "tile.samples");
    port(c.inverse_samples, "tile.inverse_samples");
    port(c.grid, "tile.grid");
    port(c.inverse_grid, "tile.inverse_grid");
  }
};

/// A light source of any kind. Point and spot lights: `local` is 1, `position` its position, `reach` 1. Directional
/// lights: `local` is 0, `position` a unit vector towards the light, `reach` infinite. Without a cone `cone_scale` is 0
/// and `cone_offset` 1; without a range `inverse_range_squared` is 0.
template <class V>
struct LightUniforms {
  Vec3<V> position, direction, intensity;
  F<V> local, reach, cone_scale, cone_offset, inverse_range_squared;
  static constexpr void describe(auto& c, auto&& port) {
    port(c.position, "light.place");
    port(c.direction, "light.direction");
    port(c.intensity, "light.intensity");
    port(c.local, "light.local");
    port(c.reach, "light.reach");
    port(c.cone_scale, "light.cone_scale");
    port(c.cone_offset, "light.cone_offset");
    port(c.inverse_range_squared, "light.inverse_range_squared");
  }
  static void fields(auto& l, auto&& field) {
    name_all(field, NAMED_ALL(l.position, l.direction, l.intensity, l.local, l.reach, l.cone_scale, l.cone_offset,
                              l.inverse_range_squared));
  }
};

/// The samples of a tile, stored row by row with `pitch` per row, including the halo. In the picture the samples form a
/// grid, with `grid` x `grid` per pixel.
template <class V>
struct GridUniforms {
  F<V> x0, y0;  ///< position in the picture's sample grid of the tile's first sample
  F<V> pitch, inverse_pitch;
  F<V> grid, inverse_grid;
  static constexpr void describe(auto& g, auto&& port) {
    port(g.x0, "grid.x0");
    port(g.y0, "grid.y0");
    port(g.pitch, "grid.pitch");
    port(g.inverse_pitch, "grid.inverse_pitch");
    port(g.grid, "grid.grid");
    port(g.inverse_grid, "grid.inverse_grid");
  }
};

/// A regular subset of a tile's samples, with `across` of them per row. `step` and `row_step` are differences of sample
/// indices.
template <class V>
struct LatticeUniforms {
  F<V> first, across, inverse_across, step, row_step;
  static constexpr void describe(auto& lattice, auto&& port) {
    port(lattice.first, "lattice.first");
    port(lattice.across, "lattice.across");
    port(lattice.inverse_across, "lattice.inverse_across");
    port(lattice.step, "lattice.step");
    port(lattice.row_step, "lattice.row_step");
  }
};
template <class V>
I<V> lattice_sample(const I<V>& number, const LatticeUniforms<V>& lattice) {
  const DivMod<V> row = div_mod<V>(to_float(number), lattice.across, lattice.inverse_across);
  return to_int(lattice.first + row.remainder * lattice.step + row.quotient * lattice.row_step);
}

/// Value stored for a reference sample instead of its failed similarity checks, because no kernel checks reference
/// samples.
inline constexpr std::uint32_t kReferenceVerdict = 1U << 31;

}  // namespace kernels
