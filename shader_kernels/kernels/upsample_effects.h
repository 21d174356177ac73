#pragma once
#include <array>
#include <string_view>

#include "shader_kernels/kernels/add_light.h"
#include "shader_kernels/kernels/reconstruct.h"
#include "shader_kernels/kernels/select_effects.h"
#include "sim/named.h"
#include "traces/ray.h"

namespace kernels {

/// Begins what a sample keeps of one light, of several `layers` of samples: none of it, and no ray yet.
struct ClearEffects {
  static constexpr std::string_view kName = "clear_effects";
  static constexpr std::string_view kMeaning = "sample -> no light whose share is to be found, nothing found of it";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> lights;
    Local<V, RatioRecord> ratios;
    LatticeUniforms<V> lattice;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.lights));
      port(NAMED(p.ratios));
      LatticeUniforms<V>::describe(p.lattice, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> sample = lattice_sample<V>(item, at.lattice);
    const Vec3<V> none{0.0F, 0.0F, 0.0F};
    at.lights.store(sample, {none});
    at.ratios.store(sample, {none, 0.0F});
  }
};

/// As combine_shadow, of rays that bring a share instead of light.
struct CombineRatio {
  static constexpr std::string_view kName = "combine_ratio";
  static constexpr std::string_view kMeaning =
      "ray for a share of light -> that into its sample's, unless it was stopped";
  template <class V>
  struct Ports {
    Local<V, HitRecord> shadow_hits;
    Local<V, PathRecord> shadow_paths;
    Local<V, RatioRecord> ratios;
    F<V> share;
    static void describe(auto& p, auto&& port) {
      port(NAMED(p.shadow_hits));
      port(NAMED(p.shadow_paths));
      port(NAMED(p.ratios));
      port(NAMED(p.share));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const M<V> lit = at.shadow_hits.load(item).triangle == traces::kNoHit;
    const PathRecord<V> path = at.shadow_paths.load(item);
    const RatioRecord<V> so_far = at.ratios.load(path.sample);
    const Vec3<V> brought = select(lit, path.throughput, Vec3<V>{0.0F, 0.0F, 0.0F});
    at.ratios.store(path.sample, {so_far.rgb + brought, so_far.found + at.share});
  }
};

/// Weight of a pixel that is not alike, where none is.
inline constexpr float kUnlikeWeight = 1e-4F;

/// A light's share at a pixel that has no rays is the mean of up to four around that have, weighted as reconstruct's
/// samples are; then its light is added. Over all pixels that a tile finishes, one launch per light.
template <bool kCheckerboard>
struct UpsampleEffects {
  static constexpr std::string_view kName = kCheckerboard ? "upsample_effects_checkerboard" : "upsample_effects";
  static constexpr std::string_view kMeaning =
      kCheckerboard ? "finished pixel, one light -> its light, by its own share or that of pixels beside it"
                    : "finished pixel, one light -> its light, by its own share or that of pixels around it";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> lights;
    Local<V, RatioRecord> ratios;
    Local<V, ColourRecord> colours;
    F<V> x0, y0;  ///< the first finished pixel in the picture
    F<V> bend;
    I<V> apart;  ///< the light's layer
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.visible));
      port(NAMED(p.lights));
      port(NAMED(p.ratios));
      port(NAMED(p.colours));
      port(NAMED(p.x0));
      port(NAMED(p.y0));
      port(NAMED(p.bend));
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item), at.finished);
    const F<V> centre = centre_sample<V>(pixel, at.finished);
    const I<V> sample = to_int(centre);
    const VisibleRecord<V> own = at.visible.load(sample);
    const I<V> of_light = sample + at.apart;
    const RatioRecord<V> found = at.ratios.load(of_light);
    const RatioRecord<V> around = sum_around<V>(pixel, centre, own, at);
    const M<V> is_found = F<V>(0.0F) < found.found;
    const M<V> is_known = F<V>(0.0F) < around.found;
    const F<V> inverse = 1.0F / select(is_known, around.found, F<V>(1.0F));
    const Vec3<V> filtered = select(is_known, around.rgb * inverse, Vec3<V>{1.0F, 1.0F, 1.0F});
    add_light<V>(at.colours, sample, at.lights.load(of_light).rgb * select(is_found, found.rgb, filtered));
  }

 private:
  /// A step to another pixel along a row or column.
  template <class V>
  struct Step {
    F<V> samples;
    M<V> inside;
  };
  template <class V>
  static Step<V> step(const F<V>& from, const F<V>& by, const F<V>& samples, const F<V>& low, const F<V>& high) {
    const F<V> to = from + by;
    const M<V> inside = both(low <= to, to <= high);
    return {select(inside, samples, F<V>(0.0F)), inside};
  }

  template <class V>
  static RatioRecord<V> sum_around(const DivMod<V>& pixel, const F<V>& centre, const VisibleRecord<V>& own,
                                   Ports<V>& at) {
    const FinishedUniforms<V>& of = at.finished;
    F<V> left = -1.0F, right = 1.0F, above = -1.0F, below = 1.0F;
    if constexpr (!kCheckerboard) {  // 0 in columns, or rows, of those that have rays
      right = to_float(to_int(at.x0 + pixel.remainder) & 1U);
      below = to_float(to_int(at.y0 + pixel.quotient) & 1U);
      left = -right;
      above = -below;
    }
    const std::array<Step<V>, 2> columns{step<V>(pixel.remainder, left, left, of.low_x, of.high_x),
                                         step<V>(pixel.remainder, right, right, of.low_x, of.high_x)};
    const std::array<Step<V>, 2> rows{step<V>(pixel.quotient, above, above * of.pitch, of.low_y, of.high_y),
                                      step<V>(pixel.quotient, below, below * of.pitch, of.low_y, of.high_y)};
    RatioRecord<V> sum{{0.0F, 0.0F, 0.0F}, 0.0F};
    for (std::uint32_t tap = 0; tap < 4; ++tap) {
      const Step<V>& column = columns[tap % 2];
      const Step<V>& row = rows[tap / 2];
      if constexpr (kCheckerboard) {
        const Step<V>& beside = tap < 2 ? column : rows[tap % 2];
        add<V>(sum, centre + beside.samples, beside.inside, own, at);
      } else {
        add<V>(sum, centre + column.samples + row.samples, both(column.inside, row.inside), own, at);
      }
    }
    return sum;
  }

  template <class V>
  static void add(RatioRecord<V>& sum, const F<V>& index, const M<V>& inside, const VisibleRecord<V>& own,
                  Ports<V>& at) {
    const I<V> sample = to_int(index);
    const RatioRecord<V> ratio = at.ratios.load(sample + at.apart);
    const F<V> alike = Similarity<V>(own, at.visible.load(sample), at.bend).weight();
    const F<V> weight = select(inside, max(alike, F<V>(kUnlikeWeight)) * ratio.found, F<V>(0.0F));
    sum = {sum.rgb + ratio.rgb * weight, sum.found + weight};
  }
};

}  // namespace kernels
