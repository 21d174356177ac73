#pragma once
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "shader_kernels/kernels/generate_visible_rays.h"
#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

/// Weight of a shaded sample's colour at another sample: exp(-dz^2) exp(-(bend (1 - n.n))^2), and 0 where a light
/// reaches the one and not the other. Depths have their factor in them.
template <class V>
struct Similarity {
  F<V> depth, normal;  ///< the exponents
  M<V> same_shadows;
  Similarity(const VisibleRecord<V>& a, const VisibleRecord<V>& b, const F<V>& bend)
      : depth(b.depth - a.depth),
        normal((1.0F - clamped<V>(dot(a.normal, b.normal))) * bend),
        same_shadows(a.shadows == b.shadows) {
    depth = depth * depth;
    normal = normal * normal;
  }
  F<V> weight() const { return select(same_shadows, decay<V>(depth + normal), F<V>(0.0F)); }
};

/// Sum of a weight's exponents that halves it.
inline constexpr float kHalved = 0.69314718F;
/// Weights that sum to less are none.
inline constexpr float kLeastWeight = 1e-30F;

/// Whether a sample's record of a branch is that of a ray.
template <class V>
M<V> has_branch(const VisibleRecord<V>& record) {
  return F<V>(0.5F * kNoBranchDepth) < record.depth;
}

/// Shaded samples around that of a pixel, row by row: square of 2 kRadius + 1.
template <std::uint32_t kRadius, class V>
class ShadedAround {
 public:
  static constexpr std::uint32_t kSide = 2 * kRadius + 1, kTaps = kSide * kSide, kOwn = kTaps / 2;
  ShadedAround(const DivMod<V>& pixel, const FinishedUniforms<V>& of)
      : columns_(steps(pixel.remainder, of.low_x, of.high_x, [](float by) { return F<V>(by); })),
        rows_(steps(pixel.quotient, of.low_y, of.high_y, [&](float by) { return of.pitch * by; })) {}

  /// Calls f(number of the sample, whether it lies inside the picture) for sample t, not the pixel's own, around that
  /// at `centre`.
  auto at(std::uint32_t t, const F<V>& centre, auto&& f) const {
    const std::uint32_t x = t % kSide, y = t / kSide;
    if (x == kRadius) return f(centre + rows_[step_to(y)].samples, rows_[step_to(y)].inside);
    if (y == kRadius) return f(centre + columns_[step_to(x)].samples, columns_[step_to(x)].inside);
    const Step &column = columns_[step_to(x)], &row = rows_[step_to(y)];
    return f(centre + column.samples + row.samples, both(column.inside, row.inside));
  }

 private:
  /// A step to another column or row; none where the picture ends.
  struct Step {
    F<V> samples;
    M<V> inside;
  };
  using Steps = std::array<Step, 2 * kRadius>;
  /// Steps by -kRadius to kRadius, but 0, from `from`; `samples` says how many samples that is.
  static Steps steps(const F<V>& from, const F<V>& low, const F<V>& high, auto&& samples) {
    const auto step = [&](std::size_t n) -> Step {
      const float by = static_cast<float>(n < kRadius ? n : n + 1) - static_cast<float>(kRadius);
      const F<V> to = from + by;
      const M<V> inside = both(low <= to, to <= high);
      return {select(inside, samples(by), F<V>(0.0F)), inside};
    };
    return [&]<std::size_t... n>(std::index_sequence<n...>) { return Steps{step(n)...}; }
    (std::make_index_sequence<2 * kRadius>{});
  }
  /// The step to a column or row, of kSide.
  static constexpr std::uint32_t step_to(std::uint32_t n) { return n < kRadius ? n : n - 1; }

  const Steps columns_, rows_;
};

/// Lists the pixels that see something by a mirror or through glass.
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
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.visible));
      port(NAMED(p.masters));
      port(NAMED(p.masters_count));
      port(NAMED(p.branch));
      port(NAMED(p.apart));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item), at.finished);
    I<V> sample = to_int(centre_sample<V>(pixel, at.finished) + at.branch);
    M<V> any = has_branch<V>(at.visible.load(sample));
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      sample = sample + at.apart;
      any = logical_or(any, has_branch<V>(at.visible.load(sample)));
    }
    at.masters.store(at.masters_count.next(any), {item});
  }
};

/// The filter of reconstruct: the colour of each of a pixel's four samples is the mean of the shaded samples around,
/// each with its weight; the pixel's is the mean of the four. Every shaded sample is loaded once for all four:
///
///   pixel = 1/4 sum_i (sum_j w_ij c_j) / (sum_j w_ij) = sum_j c_j (sum_i w_ij r_i),   r_i = 1/4 / sum_j w_ij
///
/// A sample that no shaded one is like has the colour of its pixel's own. With kBranch it is what mirrors or glass
/// show, over a list of pixels, and is added: samples that send no ray that way have none of it.
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
    Local<V, WordRecord> masters;  ///< wired if kBranch, as `branch` is
    Local<V, VisibleRecord> visible;
    Local<V, ColourRecord> colours, pixels;
    F<V> bend, branch;
    I<V> apart;
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      if constexpr (kBranch) port(NAMED(p.masters));
      port(NAMED(p.visible));
      port(NAMED(p.colours));
      port(NAMED(p.pixels));
      port(NAMED(p.bend));
      if constexpr (kBranch) port(NAMED(p.branch));
      port(NAMED(p.apart));
    }
  };

  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    I<V> listed = item;
    if constexpr (kBranch) listed = at.masters.load(item).word;
    const DivMod<V> pixel = finished_pixel<V>(to_float(listed), at.finished);
    F<V> centre = centre_sample<V>(pixel, at.finished);
    if constexpr (kBranch) centre = centre + at.branch;
    const Vec3<V> sum = filtered<V>(pixel, centre, at);
    if constexpr (kBranch) {
      at.pixels.store(listed, {at.pixels.load(listed).rgb + sum});
    } else {
      at.pixels.store(listed, {sum});
    }
  }

 private:
  /// Weight of a shaded sample for the pixel's four.
  template <class V>
  struct Tap {
    Vec3<V> colour;
    std::array<F<V>, kGeometrySamples> weights;
  };
  template <class V>
  using Samples = std::array<VisibleRecord<V>, kGeometrySamples>;

  template <class V>
  struct Own {
    I<V> shaded;
    Samples<V> samples;
  };
  template <class V>
  static Own<V> samples_of(const F<V>& centre, Ports<V>& at) {
    Own<V> own{to_int(centre), {}};
    I<V> sample = own.shaded;
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      if (k != 0) sample = sample + at.apart;
      own.samples[k] = at.visible.load(sample);
    }
    return own;
  }

  template <class V>
  static Vec3<V> filtered(const DivMod<V>& pixel, const F<V>& centre, Ports<V>& at) {
    const Own<V> own = samples_of<V>(centre, at);
    const ShadedAround<kRadius, V> around(pixel, at.finished);
    std::array<Tap<V>, kTaps> taps;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      taps[t] = t == kOwn ? own_tap<V>(own, at) : around.at(t, centre, [&](const F<V>& index, const M<V>& inside) {
        return tap<V>(own, index, inside, at);
      });
    }
    const std::array<F<V>, kGeometrySamples> shares = shares_of<V>(own.samples, taps);
    Vec3<V> sum;
    for (std::uint32_t t = 0; t < kTaps; ++t) {
      F<V> share = taps[t].weights[0] * shares[0];
      for (std::uint32_t k = 1; k < kGeometrySamples; ++k) share = share + taps[t].weights[k] * shares[k];
      const Vec3<V> part = taps[t].colour * share;
      sum = t == 0 ? part : sum + part;
    }
    return sum;
  }

  /// Each sample's part of the pixel over the sum of its weights.
  template <class V>
  static std::array<F<V>, kGeometrySamples> shares_of(const Samples<V>& own, std::array<Tap<V>, kTaps>& taps) {
    std::array<F<V>, kGeometrySamples> shares;
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      F<V> all = taps[0].weights[k];
      for (std::uint32_t t = 1; t < kTaps; ++t) all = all + taps[t].weights[k];
      if (k != 0) {  // the shaded one is like itself
        const M<V> alone = all < kLeastWeight;
        all = select(alone, F<V>(1.0F), all);
        taps[kOwn].weights[k] = select(alone, F<V>(1.0F), taps[kOwn].weights[k]);
      }
      shares[k] = 0.25F / all;
      if constexpr (kBranch) shares[k] = select(has_branch<V>(own[k]), shares[k], F<V>(0.0F));
    }
    return shares;
  }

  /// The shaded sample of the pixel itself.
  template <class V>
  static Tap<V> own_tap(const Own<V>& own, Ports<V>& at) {
    Tap<V> out{at.colours.load(own.shaded).rgb, {}};
    out.weights[0] = 1.0F;
    for (std::uint32_t k = 1; k < kGeometrySamples; ++k) {
      out.weights[k] = Similarity<V>(own.samples[k], own.samples[0], at.bend).weight();
    }
    return out;
  }

  /// That at `place`, of another pixel.
  template <class V>
  static Tap<V> tap(const Own<V>& own, const F<V>& index, const M<V>& inside, Ports<V>& at) {
    const I<V> sample = to_int(index);
    VisibleRecord<V> record = at.visible.load(sample);
    record.depth = select(inside, record.depth, F<V>(kOutsideDepth));
    Tap<V> out{at.colours.load(sample).rgb, {}};
    for (std::uint32_t k = 0; k < kGeometrySamples; ++k) {
      out.weights[k] = Similarity<V>(own.samples[k], record, at.bend).weight();
    }
    return out;
  }
};

}  // namespace kernels
