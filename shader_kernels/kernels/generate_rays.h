#pragma once
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/subpixels.h"
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
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.rays, p.paths, p.colours));
    CameraUniforms<V>::describe(p.camera, port);
    TileUniforms<V>::describe(p.tile, port);
    name_all(port, NAMED_ALL(p.image_width, p.seed));
  }
};

/// Position of a sample: its pixel in the picture, and its cell in the pixel's sample grid.
template <class V>
struct SamplePosition {
  F<V> x, y;         ///< position of the pixel in the picture
  F<V> column, row;  ///< the sample's cell in the sample grid of the pixel
  F<V> number;       ///< number of the sample's cell in its pixel, row by row
};
template <class V>
SamplePosition<V> sample_position(const I<V>& item, const TileUniforms<V>& tile) {
  const DivMod<V> pixel = div_mod<V>(to_float(item), tile.samples, tile.inverse_samples);
  const DivMod<V> row = div_mod<V>(pixel.quotient, tile.width, tile.inverse_width);
  const DivMod<V> cell = div_mod<V>(pixel.remainder, tile.grid, tile.inverse_grid);
  return {tile.x0 + row.remainder, tile.y0 + row.quotient, cell.remainder, cell.quotient, pixel.remainder};
}

/// Stores the primary ray of `sample` in ray slot `item`. The ray goes through picture position (x, y), in pixels.
template <class V>
void emit_primary_ray(const I<V>& item, const I<V>& sample, const F<V>& x, const F<V>& y, const auto& io) {
  const Vec3<V> direction = unit_vector(io.camera.corner + io.camera.right * x + io.camera.down * y);
  io.rays.store(item, {io.camera.origin, 0.0F, direction, std::numeric_limits<float>::infinity()});
  io.paths.store(item, {{1.0F, 1.0F, 1.0F}, sample});
  io.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
}

struct GenerateRays {
  static constexpr std::string_view kName = "generate_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples at the centres of a regular grid";
  template <class V>
  using Ports = GeneratePorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SamplePosition<V> s = sample_position<V>(item, io.tile);
    emit_primary_ray<V>(item, item, s.x + (s.column + 0.5F) * io.tile.inverse_grid,
                        s.y + (s.row + 0.5F) * io.tile.inverse_grid, io);
  }
};

/// A random point in a cell of a pixel's sample grid. The point depends only on the frame's seed, the pixel and the
/// cell.
template <class V>
struct Jitter {
  F<V> x, y;
};
template <class V>
Jitter<V> jittered_point(const I<V>& pixel, const I<V>& cell, const I<V>& seed) {
  const I<V> hash_x = scramble_bits<V>(scramble_bits<V>(pixel ^ seed) + cell);
  const I<V> hash_y = scramble_bits<V>(hash_x ^ 0x9e3779b9U);
  return {hash_to_unit_float<V>(hash_x), hash_to_unit_float<V>(hash_y)};
}

struct GenerateJitteredRays {
  static constexpr std::string_view kName = "generate_jittered_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples anywhere in the cells of a grid";
  template <class V>
  using Ports = GeneratePorts<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const SamplePosition<V> s = sample_position<V>(item, io.tile);
    const I<V> pixel = to_int(s.y) * io.image_width + to_int(s.x);
    const Jitter<V> in_cell = jittered_point<V>(pixel, to_int(s.number), io.seed);
    emit_primary_ray<V>(item, item, s.x + (s.column + in_cell.x) * io.tile.inverse_grid,
                        s.y + (s.row + in_cell.y) * io.tile.inverse_grid, io);
  }
};

/// Number of samples per pixel in the program reconstruct; also the number of rows of the grid on which they are
/// placed.
inline constexpr std::uint32_t kGeometrySamples = 4;

/// Returns the grid column of sample k of four in a pixel: row k of 4 x 4 cells has its sample in column (2 k + 1) mod
/// 5.
template <class V>
F<V> rotated_grid_column(const F<V>& k) {
  const F<V> column = k + k + 1.0F;
  return column - select(F<V>(4.0F) < column, F<V>(5.0F), F<V>(0.0F));
}

/// Generates rays on a rotated grid: each row and column of a pixel's n^2 x n^2 cells has one sample. Sample k of n x n
/// is in row k and column n (k + 1) mod (n^2 + 1) - 1. With n = 2 these are the samples of the program reconstruct;
/// with n = 1 the sample is centred.
struct GenerateRotatedRays {
  static constexpr std::string_view kName = "generate_rotated_rays";
  static constexpr std::string_view kMeaning = "sample -> primary ray, samples on a rotated grid";
  template <class V>
  struct Ports : GeneratePorts<V> {
    F<V> cycle, inverse_cycle;  ///< n^2 + 1, where the pixel has n x n samples
    static constexpr void describe(auto& p, auto&& port) {
      GeneratePorts<V>::describe(p, port);
      name_all(port, NAMED_ALL(p.cycle, p.inverse_cycle));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.tile.samples, io.tile.inverse_samples);
    const DivMod<V> row = div_mod<V>(pixel.quotient, io.tile.width, io.tile.inverse_width);
    const F<V> number = pixel.remainder;
    const DivMod<V> column = div_mod<V>((number + 1.0F) * io.tile.grid, io.cycle, io.inverse_cycle);
    emit_primary_ray<V>(item, item, io.tile.x0 + row.remainder + (column.remainder - 0.5F) * io.tile.inverse_samples,
                        io.tile.y0 + row.quotient + (number + 0.5F) * io.tile.inverse_samples, io);
  }
};

/// Lists the reference samples of a tile, which are always traced.
struct ListSamples {
  static constexpr std::string_view kName = "list_samples";
  static constexpr std::string_view kMeaning = "number -> reference sample";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples, verdicts;
    LatticeUniforms<V> lattice;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.verdicts));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = lattice_sample<V>(item, io.lattice);
    io.samples.store(item, {sample});
    io.verdicts.store(sample, {kReferenceVerdict});
  }
};

/// Generates the primary rays of the samples in a list. The rays equal those of the kernel generate_rays.
struct GenerateListedRays {
  static constexpr std::string_view kName = "generate_listed_rays";
  static constexpr std::string_view kMeaning = "listed sample -> primary ray, samples at the centres of a regular grid";
  template <class V>
  struct Ports {
    Local<V, WordRecord> samples;
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours;
    CameraUniforms<V> camera;
    GridUniforms<V> grid;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.samples, p.rays, p.paths, p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      GridUniforms<V>::describe(p.grid, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> sample = io.samples.load(item).word;
    const DivMod<V> row = div_mod<V>(to_float(sample), io.grid.pitch, io.grid.inverse_pitch);
    const DivMod<V> x = div_mod<V>(io.grid.x0 + row.remainder, io.grid.grid, io.grid.inverse_grid);
    const DivMod<V> y = div_mod<V>(io.grid.y0 + row.quotient, io.grid.grid, io.grid.inverse_grid);
    emit_primary_ray<V>(item, sample, x.quotient + (x.remainder + 0.5F) * io.grid.inverse_grid,
                        y.quotient + (y.remainder + 0.5F) * io.grid.inverse_grid, io);
  }
};

/// Generates four primary rays for each active sub-pixel (a quarter of a pixel). Of the 16 rays that the kernel
/// generate_jittered_rays would generate for the pixel, they are the four in that quarter.
struct GenerateExtraRays {
  static constexpr std::string_view kName = "generate_extra_rays";
  static constexpr std::string_view kMeaning = "active sub-pixel -> four primary rays, anywhere in their cells";
  template <class V>
  struct Ports {
    Local<V, WordRecord> active;
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours;
    CameraUniforms<V> camera;
    F<V> x0, y0, width, inverse_width;  ///< picture position of the first finished pixel; pixels per row of the tile
    F<V> first_sample;                  ///< index in `colours` of the first sample that this kernel generates
    I<V> image_width, seed;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.active, p.rays, p.paths, p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      name_all(port, NAMED_ALL(p.x0, p.y0, p.width, p.inverse_width, p.first_sample, p.image_width, p.seed));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> subpixel = io.active.load(item >> 2U).word;
    const DivMod<V> row = div_mod<V>(to_float(subpixel >> 2U), io.width, io.inverse_width);
    const F<V> x = io.x0 + row.remainder;
    const F<V> y = io.y0 + row.quotient;
    // The pixel has 4 x 4 cells: the sub-pixel gives the upper bit of column and row, the sample the lower bit.
    const I<V> column = ((subpixel & 1U) << 1U) | (item & 1U);
    const I<V> line = (subpixel & 2U) | ((item >> 1U) & 1U);
    const I<V> pixel = to_int(y) * io.image_width + to_int(x);
    const Jitter<V> in_cell = jittered_point<V>(pixel, (line << 2U) | column, io.seed);
    emit_primary_ray<V>(item, to_int(io.first_sample + to_float(item)), x + (to_float(column) + in_cell.x) * 0.25F,
                        y + (to_float(line) + in_cell.y) * 0.25F, io);
  }
};

/// Ports of the kernels that generate the primary rays of the program reconstruct. Sample k of the pixel at position p
/// of the tile buffer has index k * `apart` + p; sample 0 is shaded.
template <class V>
struct VisibleRayPorts {
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, VisibleRecord> visible;
  CameraUniforms<V> camera;
  GridUniforms<V> grid;  ///< grid of the tile's pixels; coordinates are in pixels
  LatticeUniforms<V> lattice;
  static constexpr void describe(auto& p, auto&& port) {
    name_all(port, NAMED_ALL(p.rays, p.paths, p.visible));
    CameraUniforms<V>::describe(p.camera, port);
    GridUniforms<V>::describe(p.grid, port);
    LatticeUniforms<V>::describe(p.lattice, port);
  }
};

/// Returns the geometry record that the program reconstruct stores for a ray that hits nothing.
template <class V>
VisibleRecord<V> visible_miss_record() {
  return {{0.0F, 0.0F, 1.0F}, kMissDepth, 0U};
}

/// Stores the primary ray of `sample` in ray slot `item`. The ray goes through point (x, y) of the pixel; x and y are
/// from 0 to 1.
template <class V>
void emit_ray_in_pixel(const I<V>& item, const I<V>& pixel, const I<V>& sample, const F<V>& x, const F<V>& y,
                       auto& io) {
  const DivMod<V> row = div_mod<V>(to_float(pixel), io.grid.pitch, io.grid.inverse_pitch);
  const Vec3<V> direction = unit_vector(io.camera.corner + io.camera.right * (io.grid.x0 + row.remainder + x) +
                                        io.camera.down * (io.grid.y0 + row.quotient + y));
  io.rays.store(item, {io.camera.origin, 0.0F, direction, std::numeric_limits<float>::infinity()});
  io.paths.store(item, {{1.0F, 1.0F, 1.0F}, sample});
}

/// Stores the primary ray of `sample`, as emit_ray_in_pixel() does, and sets its geometry record to a miss.
template <class V>
void emit_visible_ray(const I<V>& item, const I<V>& pixel, const I<V>& sample, const F<V>& x, const F<V>& y, auto& io) {
  emit_ray_in_pixel<V>(item, pixel, sample, x, y, io);
  io.visible.store(sample, visible_miss_record<V>());
}

/// One of the three samples of a pixel for which program reconstruct finds only geometry, without shading.
template <class V>
struct GeometrySample {
  F<V> pixel, number, x, y;
};
/// Returns the sample for which item `item` generates a ray; three consecutive items belong to one pixel.
template <class V>
GeometrySample<V> unshaded_sample(const I<V>& item) {
  const DivMod<V> of_pixel = div_mod<V>(to_float(item), F<V>(3.0F), F<V>(1.0F / 3.0F));
  const F<V> k = of_pixel.remainder + 1.0F;
  const F<V> x = rotated_grid_column<V>(k) * 0.25F + 0.125F;
  return {of_pixel.quotient, k, x, k * 0.25F + 0.125F};
}

struct GenerateShadedRays {
  static constexpr std::string_view kName = "generate_shaded_rays";
  static constexpr std::string_view kMeaning = "pixel -> primary ray of the sample that is shaded";
  template <class V>
  struct Ports : VisibleRayPorts<V> {
    Local<V, ColourRecord> colours;
    static constexpr void describe(auto& p, auto&& port) {
      VisibleRayPorts<V>::describe(p, port);
      port(NAMED(p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> pixel = lattice_sample<V>(item, io.lattice);
    emit_visible_ray<V>(item, pixel, pixel, F<V>(0.375F), F<V>(0.125F), io);  // column 1, row 0 of 4 x 4 cells
    io.colours.store(pixel, {{0.0F, 0.0F, 0.0F}});
  }
};

struct GenerateCentredRays {
  static constexpr std::string_view kName = "generate_centred_rays";
  static constexpr std::string_view kMeaning = "pixel -> primary ray of its centre, whose geometry is kept";
  template <class V>
  using Ports = GenerateShadedRays::Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> pixel = lattice_sample<V>(item, io.lattice);
    emit_visible_ray<V>(item, pixel, pixel, F<V>(0.5F), F<V>(0.5F), io);
    io.colours.store(pixel, {{0.0F, 0.0F, 0.0F}});
  }
};

/// Generates the primary rays of the three samples per pixel that the program reconstruct does not shade, one item per
/// sample.
struct GenerateVisibleRays {
  static constexpr std::string_view kName = "generate_visible_rays";
  static constexpr std::string_view kMeaning = "sample that is not shaded -> primary ray";
  template <class V>
  struct Ports : VisibleRayPorts<V> {
    F<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      VisibleRayPorts<V>::describe(p, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const GeometrySample<V> of = unshaded_sample<V>(item);
    const I<V> pixel = lattice_sample<V>(to_int(of.pixel), io.lattice);
    emit_visible_ray<V>(item, pixel, pixel + to_int(of.number * io.apart), of.x, of.y, io);
  }
};

/// Clears the records of mirrored or refracted hits of a pixel's samples, before rays are traced.
struct ClearBranch {
  static constexpr std::string_view kName = "clear_branch";
  static constexpr std::string_view kMeaning = "pixel -> its samples see nothing by a mirror, or through glass";
  template <class V>
  struct Ports {
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> colours;
    LatticeUniforms<V> lattice;  ///< indices of the mirrored or refracted samples
    I<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.visible, p.colours));
      LatticeUniforms<V>::describe(p.lattice, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    I<V> sample = lattice_sample<V>(item, io.lattice);
    io.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      if (k != 0) sample = sample + io.apart;
      io.visible.store(sample, {{0.0F, 0.0F, 1.0F}, kNoBranchDepth, 0U});
    }
  }
};

}  // namespace kernels
