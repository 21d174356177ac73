#pragma once
#include <string_view>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/sample_grid.h"
#include "sim/named.h"

namespace kernels {

/// The same rays as generate_rays makes, for the samples of a stream.
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
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.samples));
      port(NAMED(p.rays));
      port(NAMED(p.paths));
      port(NAMED(p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      GridUniforms<V>::describe(p.grid, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = at.samples.load(item).word;
    const DivMod<V> row = divmod<V>(to_float(sample), at.grid.pitch, at.grid.inverse_pitch);
    const DivMod<V> x = divmod<V>(at.grid.x0 + row.remainder, at.grid.grid, at.grid.inverse_grid);
    const DivMod<V> y = divmod<V>(at.grid.y0 + row.quotient, at.grid.grid, at.grid.inverse_grid);
    emit_primary<V>(item, sample, x.quotient + (x.remainder + 0.5F) * at.grid.inverse_grid,
                    y.quotient + (y.remainder + 0.5F) * at.grid.inverse_grid, at);
  }
};

}  // namespace kernels
