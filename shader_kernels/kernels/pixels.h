#pragma once
#include <string_view>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"

namespace kernels {

/// Averages the samples of a pixel. Each sample is added to a running sum. The pixel's last sample divides the sum by
/// the number of samples.
struct AverageColour {
  static constexpr std::string_view kName = "average_colour";
  static constexpr std::string_view kMeaning = "sample -> mean of its pixel's samples, clamped, in linear light";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours, pixels;
    LoopCarried<V> red, green, blue;
    F<V> samples, inverse_samples;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.colours, p.pixels, p.red, p.green, p.blue, p.samples, p.inverse_samples));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.samples, io.inverse_samples);
    add_sample<V>(io, pixel, io.colours.load(item).rgb);
  }
  /// Adds a sample to the sum of its pixel. The samples of a pixel are added in order of their numbers.
  template <class V>
  static void add_sample(Ports<V>& io, const DivMod<V>& pixel, const Vec3<V>& colour) {
    const M<V> first = pixel.remainder <= 0.0F;
    const auto sum = [&](LoopCarried<V>& so_far, const F<V>& sample) {
      const F<V> next = select(first, F<V>(0.0F), so_far.get()) + clamp_to_unit<V>(sample);
      so_far.set(next);
      return next;
    };
    const Vec3<V> total{sum(io.red, colour.x), sum(io.green, colour.y), sum(io.blue, colour.z)};
    io.pixels.store(to_int(pixel.quotient), {total * io.inverse_samples});
  }
};

/// Averages the samples of a pixel, as the kernel average_colour does, where the tile stores its samples row by row.
struct AverageSamples {
  static constexpr std::string_view kName = "average_samples";
  static constexpr std::string_view kMeaning = "sample of a grid -> mean of its pixel's samples, clamped, linear light";
  template <class V>
  struct Ports : AverageColour::Ports<V> {
    F<V> width, inverse_width;  ///< number of pixels in a row of the tile
    F<V> grid, inverse_grid;
    F<V> first, pitch;
    static constexpr void describe(auto& p, auto&& port) {
      AverageColour::Ports<V>::describe(p, port);
      name_all(port, NAMED_ALL(p.width, p.inverse_width, p.grid, p.inverse_grid, p.first, p.pitch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = div_mod<V>(to_float(item), io.samples, io.inverse_samples);
    const DivMod<V> row = div_mod<V>(pixel.quotient, io.width, io.inverse_width);
    const DivMod<V> cell = div_mod<V>(pixel.remainder, io.grid, io.inverse_grid);
    const F<V> sample =
        io.first + (row.quotient * io.grid + cell.quotient) * io.pitch + row.remainder * io.grid + cell.remainder;
    AverageColour::add_sample<V>(io, pixel, io.colours.load(to_int(sample)).rgb);
  }
};

/// Replaces the kernel average_colour for pixels with one sample: clamps the sample's colour.
struct TakeSample {
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours, pixels;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.colours, p.pixels)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    store_clamped_sample<V>(item, item, io);
  }
  template <class V>
  static void store_clamped_sample(const I<V>& pixel, const I<V>& sample, const Ports<V>& io) {
    const Vec3<V> colour = io.colours.load(sample).rgb;
    io.pixels.store(pixel, {{clamp_to_unit<V>(colour.x), clamp_to_unit<V>(colour.y), clamp_to_unit<V>(colour.z)}});
  }
};

/// Replaces the kernel average_samples for pixels with one sample: clamps the sample's colour.
struct TakeGridSample {
  template <class V>
  struct Ports : TakeSample::Ports<V> {
    LatticeUniforms<V> lattice;  ///< indices of the samples of the tile's pixels
    static constexpr void describe(auto& p, auto&& port) {
      TakeSample::Ports<V>::describe(p, port);
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    TakeSample::store_clamped_sample<V>(item, lattice_sample<V>(item, io.lattice), io);
  }
};

/// Packs a colour with channels in [0, 1] into a word of the frame buffer (RGBA8).
template <class V>
I<V> pack_pixel(const Vec3<V>& colour) {
  const auto byte = [](const F<V>& x) { return to_int(encode_srgb<V>(x) * 255.0F + 0.5F); };
  return byte(colour.x) | (byte(colour.y) << 8U) | (byte(colour.z) << 16U) | 0xff000000U;
}

struct PackColour {
  static constexpr std::string_view kName = "pack_colour";
  static constexpr std::string_view kMeaning = "pixel -> the frame buffer's RGBA8, sRGB-encoded";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> pixels;
    Local<V, WordRecord> packed;
    static constexpr void describe(auto& p, auto&& port) { name_all(port, NAMED_ALL(p.pixels, p.packed)); }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const Vec3<V> colour = io.pixels.load(item).rgb;
    io.packed.store(
        item, {pack_pixel<V>({clamp_to_unit<V>(colour.x), clamp_to_unit<V>(colour.y), clamp_to_unit<V>(colour.z)})});
  }
};

/// Kernel pack_colour for a colour that an earlier part of the fused kernel has already clamped.
struct PackClamped {
  using Of = PackColour;
  template <class V>
  using Ports = PackColour::Ports<V>;
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    io.packed.store(item, {pack_pixel<V>(io.pixels.load(item).rgb)});
  }
};

}  // namespace kernels
