#pragma once
#include <string_view>

#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

/// Four items per active sub-pixel: those of a pixel's 16 jittered samples that lie in it, the same as
/// generate_jittered_rays makes for full:16.
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
    F<V> x0, y0, width, inverse_width;  ///< first pixel that the tile finishes; pixels in a row
    F<V> first_sample;                  ///< where their colours lie
    I<V> image_width, seed;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.active));
      port(NAMED(p.rays));
      port(NAMED(p.paths));
      port(NAMED(p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      port(NAMED(p.x0));
      port(NAMED(p.y0));
      port(NAMED(p.width));
      port(NAMED(p.inverse_width));
      port(NAMED(p.first_sample));
      port(NAMED(p.image_width));
      port(NAMED(p.seed));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> subpixel = at.active.load(item >> 2U).word;
    const DivMod<V> row = divmod<V>(to_float(subpixel >> 2U), at.width, at.inverse_width);
    const F<V> x = at.x0 + row.remainder;
    const F<V> y = at.y0 + row.quotient;
    // A cell of the pixel's 4 x 4: two bits of column and row each from the sub-pixel and from the sample.
    const I<V> column = ((subpixel & 1U) << 1U) | (item & 1U);
    const I<V> line = (subpixel & 2U) | ((item >> 1U) & 1U);
    const I<V> pixel = to_int(y) * at.image_width + to_int(x);
    const Jitter<V> in_cell = jitter<V>(pixel, (line << 2U) | column, at.seed);
    emit_primary<V>(item, to_int(at.first_sample + to_float(item)), x + (to_float(column) + in_cell.x) * 0.25F,
                    y + (to_float(line) + in_cell.y) * 0.25F, at);
  }
};

}  // namespace kernels
