#pragma once
#include <limits>
#include <string_view>

#include "shader_kernels/kernels/rotated_grid.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

/// Ports of the kernels that make reconstruct's primary rays. Sample k of the pixel at position p of the tile buffer is
/// sample k * `apart` + p; the first is shaded.
template <class V>
struct VisibleRayPorts {
  Local<V, RayRecord> rays;
  Local<V, PathRecord> paths;
  Local<V, VisibleRecord> visible;
  CameraUniforms<V> camera;
  GridUniforms<V> grid;  ///< pixels
  LatticeUniforms<V> lattice;
  static void describe(auto& p, auto&& port) {
    port(NAMED(p.rays));
    port(NAMED(p.paths));
    port(NAMED(p.visible));
    CameraUniforms<V>::describe(p.camera, port);
    GridUniforms<V>::describe(p.grid, port);
    LatticeUniforms<V>::describe(p.lattice, port);
  }
};

/// The record of a ray that hits nothing.
template <class V>
VisibleRecord<V> visible_miss() {
  return {{0.0F, 0.0F, 1.0F}, kMissDepth, 0U};
}

/// The ray of `sample`, at (x, y) in the pixel at position `pixel`.
template <class V>
void emit_in_pixel(const I<V>& item, const I<V>& pixel, const I<V>& sample, const F<V>& x, const F<V>& y, auto& at) {
  const DivMod<V> row = divmod<V>(to_float(pixel), at.grid.pitch, at.grid.inverse_pitch);
  const Vec3<V> direction = normalised(at.camera.corner + at.camera.right * (at.grid.x0 + row.remainder + x) +
                                       at.camera.down * (at.grid.y0 + row.quotient + y));
  at.rays.store(item, {at.camera.origin, 0.0F, direction, std::numeric_limits<float>::infinity()});
  at.paths.store(item, {{1.0F, 1.0F, 1.0F}, sample});
}

/// The same, and its record is that of a miss.
template <class V>
void emit_visible(const I<V>& item, const I<V>& pixel, const I<V>& sample, const F<V>& x, const F<V>& y, auto& at) {
  emit_in_pixel<V>(item, pixel, sample, x, y, at);
  at.visible.store(sample, visible_miss<V>());
}

/// A sample that is not the first: of which pixel of a list, which one, and where in it.
template <class V>
struct GeometrySample {
  F<V> pixel, number, x, y;
};
/// Three items a pixel.
template <class V>
GeometrySample<V> other_sample(const I<V>& item) {
  const DivMod<V> of_pixel = divmod<V>(to_float(item), F<V>(3.0F), F<V>(1.0F / 3.0F));
  const F<V> k = of_pixel.remainder + 1.0F;
  const F<V> x = rotated_column<V>(k) * 0.25F + 0.125F;
  return {of_pixel.quotient, k, x, k * 0.25F + 0.125F};
}

struct GenerateShadedRays {
  static constexpr std::string_view kName = "generate_shaded_rays";
  static constexpr std::string_view kMeaning = "pixel -> primary ray of the sample that is shaded";
  template <class V>
  struct Ports : VisibleRayPorts<V> {
    Local<V, ColourRecord> colours;
    static void describe(auto& p, auto&& port) {
      VisibleRayPorts<V>::describe(p, port);
      port(NAMED(p.colours));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> pixel = lattice_sample<V>(item, at.lattice);
    emit_visible<V>(item, pixel, pixel, F<V>(0.375F), F<V>(0.125F), at);  // column 1, row 0 of 4 x 4
    at.colours.store(pixel, {{0.0F, 0.0F, 0.0F}});
  }
};

struct GenerateCentredRays {
  static constexpr std::string_view kName = "generate_centred_rays";
  static constexpr std::string_view kMeaning = "pixel -> primary ray of its centre, whose geometry is kept";
  template <class V>
  using Ports = GenerateShadedRays::Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> pixel = lattice_sample<V>(item, at.lattice);
    emit_visible<V>(item, pixel, pixel, F<V>(0.5F), F<V>(0.5F), at);
    at.colours.store(pixel, {{0.0F, 0.0F, 0.0F}});
  }
};

/// Three items a pixel.
struct GenerateVisibleRays {
  static constexpr std::string_view kName = "generate_visible_rays";
  static constexpr std::string_view kMeaning = "sample that is not shaded -> primary ray";
  template <class V>
  struct Ports : VisibleRayPorts<V> {
    F<V> apart;
    static void describe(auto& p, auto&& port) {
      VisibleRayPorts<V>::describe(p, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const GeometrySample<V> of = other_sample<V>(item);
    const I<V> pixel = lattice_sample<V>(to_int(of.pixel), at.lattice);
    emit_visible<V>(item, pixel, pixel + to_int(of.number * at.apart), of.x, of.y, at);
  }
};

/// Begins what a pixel's samples keep of a branch: none of them has it yet.
struct ClearBranch {
  static constexpr std::string_view kName = "clear_branch";
  static constexpr std::string_view kMeaning = "pixel -> its samples see nothing by a mirror, or through glass";
  template <class V>
  struct Ports {
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> colours;
    LatticeUniforms<V> lattice;  ///< those of the branch's samples
    I<V> apart;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.visible));
      port(NAMED(p.colours));
      LatticeUniforms<V>::describe(p.lattice, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    I<V> sample = lattice_sample<V>(item, at.lattice);
    at.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      if (k != 0) sample = sample + at.apart;
      at.visible.store(sample, {{0.0F, 0.0F, 1.0F}, kNoBranchDepth, 0U});
    }
  }
};

}  // namespace kernels
