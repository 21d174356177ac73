#pragma once
#include <string_view>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

/// Bits of an attribute set, counted from its first, that differ between two pixels; all of them only if one of the two
/// objects has the flag `focus` (0: any has). Normals are the same if their dot product is at least `same_normal`.
template <class V>
I<V> disagreements(const TraitsRecord<V>& own, const TraitsRecord<V>& other, const F<V>& same_normal,
                   const I<V>& focus) {
  constexpr std::uint32_t kObject = 1, kNormal = 2, kShadow = 4;
  const I<V> differ = select(own.object == other.object, I<V>(0U), I<V>(kObject)) |
                      select(dot(own.normal, other.normal) < same_normal, I<V>(kNormal), I<V>(0U)) |
                      select(own.shadows == other.shadows, I<V>(0U), I<V>(kShadow));
  return select(((own.object | other.object) & focus) == focus, differ, I<V>(0U));
}

/// Contrast of one channel (Mitchell 1987) of linear colours, clamped and sRGB-encoded: 0 for equal ones, black too,
/// and at most 1.
template <class V>
F<V> contrast(const F<V>& a, const F<V>& b, const F<V>& c, const F<V>& d) {
  const F<V> most = encoded<V>(clamped<V>(max(max(a, b), max(c, d))));
  const F<V> least = encoded<V>(clamped<V>(min(min(a, b), min(c, d))));
  return (most - least) / max(most + least, F<V>(1e-30F));
}

/// The inspector of supersampling (Jin et al. 2009), once for each of a pixel's four sub-pixels: compares the pixel
/// with the three around the sub-pixel's corner. The smallest threshold of the attributes that disagree applies to the
/// contrast of the four colours.
struct TestSubpixels {
  static constexpr std::string_view kName = "test_subpixels";
  static constexpr std::string_view kMeaning =
      "sub-pixel and three neighbours -> whether it needs more samples, and why";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    Local<V, TraitsRecord> traits, secondary;
    Local<V, ColourRecord> colours;
    Local<V, WordRecord> verdicts;
    std::array<F<V>, kAttributes> thresholds;  ///< above 1: no contrast is enough
    F<V> same_normal;
    I<V> compared;         ///< attributes that count, a bit each
    I<V> focus, textured;  ///< flags that objects need: one of a pair; with a texture
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      port(NAMED(p.traits));
      port(NAMED(p.secondary));
      port(NAMED(p.colours));
      port(NAMED(p.verdicts));
      for (std::size_t i = 0; i < kAttributes; ++i) port(p.thresholds[i], names_of(Attribute{})[i]);
      port(NAMED(p.same_normal));
      port(NAMED(p.compared));
      port(NAMED(p.focus));
      port(NAMED(p.textured));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item >> 2U), at.finished);
    const CornerSteps<V> step =
        corner_steps<V>(pixel, to_float((item << 1U) & 2U) - 1.0F, to_float(item & 2U) - 1.0F, at.finished);
    const F<V> own = centre_sample<V>(pixel, at.finished);
    // One that is not there is the pixel itself, which differs from itself in nothing.
    const I<V> centre = to_int(own);
    const I<V> beside = to_int(own + step.x);
    const I<V> above = to_int(own + step.y);
    const I<V> corner = to_int(select(step.has_both, own + step.x + step.y, own));

    const I<V> primary = differing<V>(at.traits, centre, beside, above, corner, at);
    const I<V> secondary = differing<V>(at.secondary, centre, beside, above, corner, at);
    const I<V> counting = ((primary << 1U) | (secondary << 5U)) & at.compared;
    F<V> threshold = kNever;
    for (std::uint32_t i = 1; i < kAttributes; ++i) {
      threshold = min(threshold, select((counting & (1U << i)) == 0U, F<V>(kNever), at.thresholds[i]));
    }
    const M<V> none = counting == 0U;
    threshold = select(none, at.thresholds[0], threshold);

    const Vec3<V> a = at.colours.load(centre).rgb;
    const Vec3<V> b = at.colours.load(beside).rgb;
    const Vec3<V> c = at.colours.load(above).rgb;
    const Vec3<V> d = at.colours.load(corner).rgb;
    const M<V> active = logical_or(logical_or(threshold * kChannelFactors[0] <= contrast<V>(a.x, b.x, c.x, d.x),
                                              threshold * kChannelFactors[1] <= contrast<V>(a.y, b.y, c.y, d.y)),
                                   threshold * kChannelFactors[2] <= contrast<V>(a.z, b.z, c.z, d.z));
    at.verdicts.store(item, {select(none, I<V>(bit(Attribute::kColour)), counting) |
                             select(active, I<V>(1U << kActiveShift), I<V>(0U))});
  }

 private:
  /// Bits of one attribute set; its texture disagrees wherever the pixel itself has one.
  template <class V>
  static I<V> differing(const Local<V, TraitsRecord>& set, const I<V>& centre, const I<V>& beside, const I<V>& above,
                        const I<V>& corner, const Ports<V>& at) {
    constexpr std::uint32_t kTexture = 8;
    const TraitsRecord<V> own = set.load(centre);
    const TraitsRecord<V> one = set.load(beside);
    const TraitsRecord<V> two = set.load(above);
    const TraitsRecord<V> three = set.load(corner);
    return disagreements<V>(own, one, at.same_normal, at.focus) | disagreements<V>(own, two, at.same_normal, at.focus) |
           disagreements<V>(own, three, at.same_normal, at.focus) |
           select((own.object & at.textured) == at.textured, I<V>(kTexture), I<V>(0U));
  }
};

}  // namespace kernels
