#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/reconstruct.h"
#include "sim/named.h"

namespace kernels {

/// Lists the pixels whose colour changes where geometry does not: edges of textures, which the filter of reconstruct
/// blurs. As the colour test of supersample, but over 3 x 3 shaded samples at once: a pixel is listed if the contrast
/// (Mitchell 1987) of its own and those that are like it reaches `threshold` in one channel. Layer by layer, so that
/// textures in mirrors and behind glass count, too.
template <std::uint32_t kBranches>
struct ListContrasts {
  static constexpr std::array<std::string_view, 3> kNames{"list_contrasts", "list_contrasts_branch",
                                                          "list_contrasts_branches"};
  static constexpr std::string_view kName = kNames[kBranches];
  static constexpr std::string_view kMeaning =
      "finished pixel -> listed if shaded samples around that are alike differ in colour";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> colours;
    Local<V, WordRecord> masters;
    Counter<V> masters_count;
    F<V> bend, threshold;
    F<V> branch;  ///< from a sample to that of its next branch; wired if there are any
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.visible));
      port(NAMED(p.colours));
      port(NAMED(p.masters));
      port(NAMED(p.masters_count));
      port(NAMED(p.bend));
      port(NAMED(p.threshold));
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item), at.finished);
    const ShadedAround<1, V> around(pixel, at.finished);
    F<V> centre = centre_sample<V>(pixel, at.finished);
    M<V> any = differs<V>(centre, around, at);
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      centre = centre + at.branch;
      any = logical_or(any, differs<V>(centre, around, at));
    }
    at.masters.store(at.masters_count.next(any), {item});
  }

 private:
  /// Whether one layer's colours differ around its sample at `centre`.
  template <class V>
  static M<V> differs(const F<V>& centre, const ShadedAround<1, V>& around, Ports<V>& at) {
    const I<V> own = to_int(centre);
    const VisibleRecord<V> record = at.visible.load(own);
    const Vec3<V> colour = at.colours.load(own).rgb;
    Vec3<V> least = colour, most = colour;
    for (std::uint32_t t = 0; t < ShadedAround<1, V>::kTaps; ++t) {
      if (t == ShadedAround<1, V>::kOwn) continue;
      const Vec3<V> seen = around.at(t, centre, [&](const F<V>& index, const M<V>& inside) {
        const I<V> sample = to_int(index);
        VisibleRecord<V> other = at.visible.load(sample);
        other.depth = select(inside, other.depth, F<V>(kOutsideDepth));
        const Similarity<V> similar(record, other, at.bend);
        const M<V> alike = both(similar.same_shadows, similar.depth + similar.normal < kHalved);
        return select(alike, at.colours.load(sample).rgb, colour);
      });
      least = {min(least.x, seen.x), min(least.y, seen.y), min(least.z, seen.z)};
      most = {max(most.x, seen.x), max(most.y, seen.y), max(most.z, seen.z)};
    }
    const M<V> red = at.threshold * kChannelFactors[0] <= contrast_of<V>(least.x, most.x);
    const M<V> green = at.threshold * kChannelFactors[1] <= contrast_of<V>(least.y, most.y);
    const M<V> blue = at.threshold * kChannelFactors[2] <= contrast_of<V>(least.z, most.z);
    return logical_or(logical_or(red, green), blue);
  }
  template <class V>
  static F<V> contrast_of(const F<V>& least, const F<V>& most) {
    const F<V> high = encoded<V>(clamped<V>(most));
    const F<V> low = encoded<V>(clamped<V>(least));
    return (high - low) / max(high + low, F<V>(1e-30F));
  }
};

/// Three items a listed pixel.
struct GenerateContrastRays {
  static constexpr std::string_view kName = "generate_contrast_rays";
  static constexpr std::string_view kMeaning = "sample of a listed pixel that is not shaded yet -> primary ray";
  template <class V>
  struct Ports {
    Local<V, WordRecord> masters;
    Local<V, RayRecord> rays;
    Local<V, PathRecord> paths;
    Local<V, ColourRecord> colours;
    CameraUniforms<V> camera;
    GridUniforms<V> grid;  ///< pixels
    FinishedUniforms<V> finished;
    F<V> apart;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.masters));
      port(NAMED(p.rays));
      port(NAMED(p.paths));
      port(NAMED(p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      GridUniforms<V>::describe(p.grid, port);
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const GeometrySample<V> of = other_sample<V>(item);
    const I<V> listed = at.masters.load(to_int(of.pixel)).word;
    const I<V> pixel = to_int(centre_sample<V>(finished_pixel<V>(to_float(listed), at.finished), at.finished));
    const I<V> sample = pixel + to_int(of.number * at.apart);
    emit_in_pixel<V>(item, pixel, sample, of.x, of.y, at);
    at.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
  }
};

/// The colour of a listed pixel, all of whose samples are shaded.
template <std::uint32_t kBranches>
struct AverageContrasts {
  static constexpr std::array<std::string_view, 3> kNames{"average_contrasts", "average_contrasts_branch",
                                                          "average_contrasts_branches"};
  static constexpr std::string_view kName = kNames[kBranches];
  static constexpr std::string_view kMeaning = "listed pixel -> mean of its four samples, clamped, linear light";
  template <class V>
  struct Ports {
    Local<V, WordRecord> masters;
    Local<V, ColourRecord> colours, pixels;
    FinishedUniforms<V> finished;
    I<V> apart;
    I<V> branch;  ///< wired if there are any
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.masters));
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.apart));
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> listed = at.masters.load(item).word;
    const I<V> own = to_int(centre_sample<V>(finished_pixel<V>(to_float(listed), at.finished), at.finished));
    // Parts of the first one, which sum to its clamped colour.
    Vec3<V> sum = at.colours.load(own).rgb;
    I<V> sample = own;
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      sample = sample + at.branch;
      sum = sum + at.colours.load(sample).rgb;
    }
    sample = own;
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      sample = sample + at.apart;
      sum = sum + clamped_colour<V>(at.colours.load(sample).rgb);
    }
    at.pixels.store(listed, {sum * 0.25F});
  }
};

}  // namespace kernels
