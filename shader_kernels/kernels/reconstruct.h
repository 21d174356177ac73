#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

#include "shader_kernels/kernels/arithmetic.h"
#include "shader_kernels/kernels/generate_rays.h"
#include "shader_kernels/kernels/subpixels.h"
#include "shader_kernels/kernels/uniforms.h"
#include "shader_kernels/ports.h"
#include "sim/named.h"

namespace kernels {

/// Position of the eye, and the viewing direction. The length of the direction vector is the number of the filter's
/// depth units in one unit of length.
template <class V>
struct EyeUniforms {
  Vec3<V> position, axis;
  static constexpr void describe(auto& e, auto&& port) {
    port(e.position, "eye.place");
    port(e.axis, "eye.axis");
  }
};

struct RecordVisible {
  static constexpr std::string_view kName = "record_visible";
  static constexpr std::string_view kMeaning = "first hit -> its sample's normal, and depth along the view";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, VisibleRecord> visible;
    EyeUniforms<V> eye;
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.surfaces));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.visible));
      EyeUniforms<V>::describe(p.eye, port);
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const SurfacePointRecord<V> point = io.points.load(slot);
    const I<V> sample = io.paths.load(slot).sample;
    io.visible.store(sample, {point.normal, dot(point.position - io.eye.position, io.eye.axis), 0U});
  }
};

/// Gives a mirrored or refracted ray a sample of its own, whose index is that of the surface's sample plus `apart`. The
/// new sample collects the light and geometry of that ray; its geometry begins as a miss.
struct BeginBranch {
  static constexpr std::string_view kName = "begin_branch";
  static constexpr std::string_view kMeaning = "ray by a mirror or through glass -> of a sample of its own";
  template <class V>
  struct Ports {
    Local<V, PathRecord> next_paths;
    Local<V, VisibleRecord> visible;
    I<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.next_paths, p.visible, p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const PathRecord<V> path = io.next_paths.load(item);
    const I<V> sample = path.sample + io.apart;
    io.next_paths.store(item, {path.throughput, sample});
    io.visible.store(sample, visible_miss_record<V>());
  }
};

/// Records the geometry of a mirrored or refracted hit. The recorded depth is the distance along that ray.
struct RecordBranchVisible {
  static constexpr std::string_view kName = "record_branch_visible";
  static constexpr std::string_view kMeaning =
      "hit behind a mirror or glass -> its sample's normal, and depth along the ray";
  template <class V>
  struct Ports {
    Local<V, WordRecord> surfaces;
    Local<V, HitRecord> hits;
    Local<V, SurfacePointRecord> points;
    Local<V, PathRecord> paths;
    Local<V, VisibleRecord> visible;
    F<V> depth_scale;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.surfaces, p.hits));
      port(p.points, "places");
      name_all(port, NAMED_ALL(p.paths, p.visible, p.depth_scale));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> slot = io.surfaces.load(item).word;
    const F<V> way = io.hits.load(slot).t;
    const Vec3<V> normal = io.points.load(slot).normal;
    const I<V> sample = io.paths.load(slot).sample;
    io.visible.store(sample, {normal, way * io.depth_scale, 0U});
  }
};

/// Weight of a shaded sample's colour at another sample: exp(-dz^2) exp(-(bend (1 - n.n))^2), or 0 if their shadows
/// differ. dz is the difference of depths, which are already scaled by the filter's factor; n are the normals.
template <class V>
struct Similarity {
  F<V> depth, normal;  ///< exponents of the weight, due to depth and due to normals
  M<V> same_shadows;
  Similarity(const VisibleRecord<V>& a, const VisibleRecord<V>& b, const F<V>& bend)
      : depth(b.depth - a.depth),
        normal((1.0F - clamp_to_unit<V>(dot(a.normal, b.normal))) * bend),
        same_shadows(a.shadows == b.shadows) {
    depth = depth * depth;
    normal = normal * normal;
  }
  F<V> filter_weight() const { return select(same_shadows, exp_negative<V>(depth + normal), F<V>(0.0F)); }
};

/// Sum of a filter weight's exponents at which the weight is one half: ln 2.
inline constexpr float kHalved = 0.69314718F;
/// Smallest sum of filter weights that counts; a sample with less has no similar shaded sample.
inline constexpr float kLeastWeight = 1e-30F;

/// True if the sample had a mirrored or refracted ray, whether it hit something or not.
template <class V>
M<V> has_path_branch(const VisibleRecord<V>& record) {
  return F<V>(0.5F * kNoBranchDepth) < record.depth;
}

/// The shaded samples of the pixels around a pixel, row by row: a square of side 2 kRadius + 1.
template <std::uint32_t kRadius, class V>
class ShadedAround {
 public:
  static constexpr std::uint32_t kSide = 2 * kRadius + 1, kTaps = kSide * kSide, kOwn = kTaps / 2;
  ShadedAround(const DivMod<V>& pixel, const FinishedUniforms<V>& tile)
      : columns_(offsets_inside_picture(pixel.remainder, tile.low_x, tile.high_x, [](float by) { return F<V>(by); })),
        rows_(offsets_inside_picture(pixel.quotient, tile.low_y, tile.high_y,
                                     [&](float by) { return tile.pitch * by; })) {}

  /// Calls f(index, inside) for the shaded sample number `t`, row by row, of the square around sample `centre`.
  /// `inside` is false outside the picture. `t` must not be the number of the centre.
  auto call_with_sample(std::uint32_t t, const F<V>& centre, auto&& f) const {
    const std::uint32_t x = t % kSide, y = t / kSide;
    if (x == kRadius) return f(centre + rows_[step_index(y)].samples, rows_[step_index(y)].inside);
    if (y == kRadius) return f(centre + columns_[step_index(x)].samples, columns_[step_index(x)].inside);
    const Step &column = columns_[step_index(x)], &row = rows_[step_index(y)];
    return f(centre + column.samples + row.samples, logical_and(column.inside, row.inside));
  }

 private:
  /// Index offset from a sample to the sample of another column or row; 0 if that column or row is outside the picture.
  struct Step {
    F<V> samples;
    M<V> inside;
  };
  using Steps = std::array<Step, 2 * kRadius>;
  /// Returns the offsets from column or row `from` to the columns or rows at distances -kRadius to kRadius, except 0.
  /// samples(n) converts a distance of n pixels to an index offset.
  static Steps offsets_inside_picture(const F<V>& from, const F<V>& low, const F<V>& high, auto&& samples) {
    const auto step = [&](std::size_t n) -> Step {
      const float by = static_cast<float>(n < kRadius ? n : n + 1) - static_cast<float>(kRadius);
      const F<V> to = from + by;
      const M<V> inside = logical_and(low <= to, to <= high);
      return {select(inside, samples(by), F<V>(0.0F)), inside};
    };
    return [&]<std::size_t... n>(std::index_sequence<n...>) { return Steps{step(n)...}; }
    (std::make_index_sequence<2 * kRadius>{});
  }
  /// Returns the index in Steps of column or row `n` of the square. The middle one, kRadius, has no entry.
  static constexpr std::uint32_t step_index(std::uint32_t n) { return n < kRadius ? n : n - 1; }

  const Steps columns_, rows_;
};

/// Lists the pixels that have a mirrored or refracted sample.
struct ListBranches {
  static constexpr std::string_view kName = "list_branches";
  static constexpr std::string_view kMeaning = "finished pixel -> listed if one of its samples sees something that way";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, VisibleRecord> visible;
    Local<V, WordRecord> masters;
    Counter<V> masters_count;
    F<V> branch;
    I<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.visible, p.masters, p.masters_count, p.branch, p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item), io.finished);
    I<V> sample = to_int(centre_sample<V>(pixel, io.finished) + io.branch);
    M<V> any = has_path_branch<V>(io.visible.load(sample));
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      sample = sample + io.apart;
      any = logical_or(any, has_path_branch<V>(io.visible.load(sample)));
    }
    io.masters.store(io.masters_count.next_index(any), {item});
  }
};

/// The filter of the program reconstruct. The colour of each of a pixel's four samples is the weighted mean of the
/// shaded samples around it; the pixel is the mean of the four. Each shaded sample is loaded once for all four:
///
///   pixel = 1/4 sum_i (sum_j w_ij c_j) / (sum_j w_ij) = sum_j c_j (sum_i w_ij r_i),   r_i = 1/4 / sum_j w_ij
///
/// A sample without similar shaded samples has the colour of its own pixel's shaded sample. With kBranch the filter
/// runs over listed pixels and adds their mirrored or refracted light; samples without such a ray add 0.
template <std::uint32_t kRadius, bool kBranch>
struct Reconstruct {
  static constexpr std::array<std::string_view, 4> kNames{"reconstruct", "reconstruct_wide", "reconstruct_branch",
                                                          "reconstruct_branch_wide"};
  static constexpr std::string_view kName = kNames[(kRadius - 1) + (kBranch ? 2 : 0)];
  static constexpr std::string_view kMeaning = kBranch ? "listed pixel -> what its samples see by a mirror or glass"
                                                       : "finished pixel -> what its samples' surfaces show";
  static constexpr std::uint32_t kTaps = ShadedAround<kRadius, float>::kTaps, kOwn = ShadedAround<kRadius, float>::kOwn;
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, WordRecord> masters;  ///< list of pixels; like `branch`, only in kBranch variants
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> colours, pixels;
    F<V> bend, branch;
    I<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      if constexpr (kBranch) port(NAMED(p.masters));
      name_all(port, NAMED_ALL(p.visible, p.colours, p.pixels, p.bend));
      if constexpr (kBranch) port(NAMED(p.branch));
      port(NAMED(p.apart));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    I<V> listed = item;
    if constexpr (kBranch) listed = io.masters.load(item).word;
    const DivMod<V> pixel = row_and_column<V>(to_float(listed), io.finished);
    F<V> centre = centre_sample<V>(pixel, io.finished);
    if constexpr (kBranch) centre = centre + io.branch;
    const Vec3<V> sum = filter_pixel<V>(pixel, centre, io);
    if constexpr (kBranch) {
      io.pixels.store(listed, {io.pixels.load(listed).rgb + sum});
    } else {
      io.pixels.store(listed, {sum});
    }
  }

 private:
  /// One shaded sample that the filter of the program reconstruct reads, with its weight for each of the pixel's four
  /// samples.
  template <class V>
  struct Tap {
    Vec3<V> colour;
    std::array<F<V>, kGeometrySamples> weights;
  };
  template <class V>
  using Samples = std::array<VisibleRecord<V>, kGeometrySamples>;

  template <class V>
  struct OwnSamples {
    I<V> shaded;
    Samples<V> samples;
  };
  template <class V>
  static OwnSamples<V> load_own_samples(const F<V>& centre, Ports<V>& io) {
    OwnSamples<V> own{to_int(centre), {}};
    I<V> sample = own.shaded;
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      if (k != 0) sample = sample + io.apart;
      own.samples[k] = io.visible.load(sample);
    }
    return own;
  }

  template <class V>
  static Vec3<V> filter_pixel(const DivMod<V>& pixel, const F<V>& centre, Ports<V>& io) {
    const OwnSamples<V> own = load_own_samples<V>(centre, io);
    const ShadedAround<kRadius, V> around(pixel, io.finished);
    std::array<Tap<V>, kTaps> taps;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      taps[t] = t == kOwn ? weigh_own_sample<V>(own, io)
                          : around.call_with_sample(t, centre, [&](const F<V>& index, const M<V>& inside) {
                              return weigh_other_sample<V>(own, index, inside, io);
                            });
    }
    const std::array<F<V>, kGeometrySamples> shares = inverse_weight_sums<V>(own.samples, taps);
    Vec3<V> sum;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      F<V> share = taps[t].weights[0] * shares[0];
      for (std::uint32_t k = 1; k < kGeometrySamples; ++k) share = share + taps[t].weights[k] * shares[k];
      const Vec3<V> part = taps[t].colour * share;
      sum = t == 0 ? part : sum + part;
    }
    return sum;
  }

  /// Returns for each of the pixel's four samples 1/4 divided by its sum of filter weights (r_i in the formula).
  template <class V>
  static std::array<F<V>, kGeometrySamples> inverse_weight_sums(const Samples<V>& own,
                                                                std::array<Tap<V>, kTaps>& taps) {
    std::array<F<V>, kGeometrySamples> shares;
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      F<V> all = taps[0].weights[k];
      for (std::uint32_t t = 1; t < kTaps; ++t) all = all + taps[t].weights[k];
      if (k != 0) {  // sample 0 is the shaded sample itself
        const M<V> alone = all < kLeastWeight;
        all = select(alone, F<V>(1.0F), all);
        taps[kOwn].weights[k] = select(alone, F<V>(1.0F), taps[kOwn].weights[k]);
      }
      shares[k] = 0.25F / all;
      if constexpr (kBranch) shares[k] = select(has_path_branch<V>(own[k]), shares[k], F<V>(0.0F));
    }
    return shares;
  }

  /// Returns the shaded sample of the filtered pixel itself, with its filter weights.
  template <class V>
  static Tap<V> weigh_own_sample(const OwnSamples<V>& own, Ports<V>& io) {
    Tap<V> out{io.colours.load(own.shaded).rgb, {}};
    out.weights[0] = 1.0F;
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      out.weights[k] = Similarity<V>(own.samples[k], own.samples[0], io.bend).filter_weight();
    }
    return out;
  }

  /// Returns the shaded sample of another pixel, at `index`, with its filter weights. All weights are 0 if `inside` is
  /// false.
  template <class V>
  static Tap<V> weigh_other_sample(const OwnSamples<V>& own, const F<V>& index, const M<V>& inside, Ports<V>& io) {
    const I<V> sample = to_int(index);
    VisibleRecord<V> record = io.visible.load(sample);
    record.depth = select(inside, record.depth, F<V>(kOutsideDepth));
    Tap<V> out{io.colours.load(sample).rgb, {}};
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      out.weights[k] = Similarity<V>(own.samples[k], record, io.bend).filter_weight();
    }
    return out;
  }
};

/// Lists the pixels whose colour changes where the geometry does not, such as at texture edges, which the filter would
/// blur. A pixel is listed if its contrast (Mitchell 1987) with the similar pixels among its eight neighbours reaches
/// `threshold` in a channel. Each layer (surface, mirrored, refracted) is tested.
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
    F<V> branch;  ///< index offset from a sample to the same sample in the next layer of light, if kBranches > 0
    static constexpr void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      name_all(port, NAMED_ALL(p.visible, p.colours, p.masters, p.masters_count, p.bend, p.threshold));
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const DivMod<V> pixel = row_and_column<V>(to_float(item), io.finished);
    const ShadedAround<1, V> around(pixel, io.finished);
    F<V> centre = centre_sample<V>(pixel, io.finished);
    M<V> any = colours_differ<V>(centre, around, io);
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      centre = centre + io.branch;
      any = logical_or(any, colours_differ<V>(centre, around, io));
    }
    io.masters.store(io.masters_count.next_index(any), {item});
  }

 private:
  /// True if the colours of one layer of light (surface, mirrored, refracted) differ too much around the sample
  /// `centre`.
  template <class V>
  static M<V> colours_differ(const F<V>& centre, const ShadedAround<1, V>& around, Ports<V>& io) {
    const I<V> own = to_int(centre);
    const VisibleRecord<V> record = io.visible.load(own);
    const Vec3<V> colour = io.colours.load(own).rgb;
    Vec3<V> least = colour, most = colour;
    for (std::uint32_t t = 0; t < ShadedAround<1, V>::kTaps; ++t) {
      if (t == ShadedAround<1, V>::kOwn) continue;
      const Vec3<V> seen = around.call_with_sample(t, centre, [&](const F<V>& index, const M<V>& inside) {
        const I<V> sample = to_int(index);
        VisibleRecord<V> other = io.visible.load(sample);
        other.depth = select(inside, other.depth, F<V>(kOutsideDepth));
        const Similarity<V> similar(record, other, io.bend);
        const M<V> alike = logical_and(similar.same_shadows, similar.depth + similar.normal < kHalved);
        return select(alike, io.colours.load(sample).rgb, colour);
      });
      least = {min(least.x, seen.x), min(least.y, seen.y), min(least.z, seen.z)};
      most = {max(most.x, seen.x), max(most.y, seen.y), max(most.z, seen.z)};
    }
    const M<V> red = io.threshold * kChannelFactors[0] <= contrast_between<V>(least.x, most.x);
    const M<V> green = io.threshold * kChannelFactors[1] <= contrast_between<V>(least.y, most.y);
    const M<V> blue = io.threshold * kChannelFactors[2] <= contrast_between<V>(least.z, most.z);
    return logical_or(logical_or(red, green), blue);
  }
  template <class V>
  static F<V> contrast_between(const F<V>& least, const F<V>& most) {
    const F<V> high = encode_srgb<V>(clamp_to_unit<V>(most));
    const F<V> low = encode_srgb<V>(clamp_to_unit<V>(least));
    return (high - low) / max(high + low, F<V>(1e-30F));
  }
};

/// Generates the primary rays of those three samples of a listed pixel that are not shaded yet.
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
    GridUniforms<V> grid;  ///< grid of the tile's pixels; coordinates are in pixels
    FinishedUniforms<V> finished;
    F<V> apart;
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.masters, p.rays, p.paths, p.colours));
      CameraUniforms<V>::describe(p.camera, port);
      GridUniforms<V>::describe(p.grid, port);
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const GeometrySample<V> of = unshaded_sample<V>(item);
    const I<V> listed = io.masters.load(to_int(of.pixel)).word;
    const I<V> pixel = to_int(centre_sample<V>(row_and_column<V>(to_float(listed), io.finished), io.finished));
    const I<V> sample = pixel + to_int(of.number * io.apart);
    emit_ray_in_pixel<V>(item, pixel, sample, of.x, of.y, io);
    io.colours.store(sample, {{0.0F, 0.0F, 0.0F}});
  }
};

/// Averages the four samples of a listed pixel. All four are shaded by then.
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
    I<V> branch;  ///< index offset from a sample to the same sample in the next layer of light, if kBranches > 0
    static constexpr void describe(auto& p, auto&& port) {
      name_all(port, NAMED_ALL(p.masters, p.colours, p.pixels));
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.apart));
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    const I<V> listed = io.masters.load(item).word;
    const I<V> own = to_int(centre_sample<V>(row_and_column<V>(to_float(listed), io.finished), io.finished));
    // The layers of the pixel's shaded sample sum to its clamped colour.
    Vec3<V> sum = io.colours.load(own).rgb;
    I<V> sample = own;
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      sample = sample + io.branch;
      sum = sum + io.colours.load(sample).rgb;
    }
    sample = own;
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      sample = sample + io.apart;
      sum = sum + clamped_colour<V>(io.colours.load(sample).rgb);
    }
    io.pixels.store(listed, {sum * 0.25F});
  }
};

/// Clamps the layers of a shaded sample's colour so that they sum to the clamped colour. The surface's own layer is
/// clamped to 1, then the mirrored and the refracted layer to what is left. The layers are filtered separately later.
template <std::uint32_t kBranches>
struct LimitColours {
  static constexpr std::array<std::string_view, 3> kNames{"limit_colours", "limit_colours_branch",
                                                          "limit_colours_branches"};
  static constexpr std::string_view kName = kNames[kBranches];
  static constexpr std::string_view kMeaning = "shaded sample -> parts of its colour that sum to at most 1";
  template <class V>
  struct Ports {
    Local<V, ColourRecord> colours;
    LatticeUniforms<V> lattice;
    I<V> branch;  ///< index offset from a sample to the same sample in the next layer of light (mirrored, refracted)
    static constexpr void describe(auto& p, auto&& port) {
      port(NAMED(p.colours));
      LatticeUniforms<V>::describe(p.lattice, port);
      if constexpr (kBranches != 0) port(NAMED(p.branch));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& io) {
    I<V> sample = lattice_sample<V>(item, io.lattice);
    const auto limited = [](const Vec3<V>& a) { return Vec3<V>{min(a.x, 1.0F), min(a.y, 1.0F), min(a.z, 1.0F)}; };
    Vec3<V> sum = limited(io.colours.load(sample).rgb);
    io.colours.store(sample, {sum});
    for (std::uint32_t branch = 0; branch < kBranches; ++branch) {
      sample = sample + io.branch;
      const Vec3<V> next = limited(sum + io.colours.load(sample).rgb);
      io.colours.store(sample, {next - sum});
      sum = next;
    }
  }
};

}  // namespace kernels
