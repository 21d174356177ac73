#pragma once
#include <cstdint>
#include <string_view>

#include "shader_kernels/kernels/subpixels.h"
#include "sim/named.h"

namespace kernels {

// State of a sub-pixel (SubpixelRecord) as rounds of propagation see it: channels of its sRGB-encoded colour, 16 bits
// each, and above the blue one its reasons and, above those, the round that has made it active: 1 for the first test, 0
// if it is not active.
inline constexpr std::uint32_t kReasonsShift = 16, kRoundShift = kReasonsShift + kAttributes;
inline constexpr std::uint32_t kReasonsMask = (1U << kAttributes) - 1;
inline constexpr std::uint32_t kChannelMask = (1U << kReasonsShift) - 1;

/// States of sub-pixels lie row by row, `pitch` to a row, from `first` on; pixels are `width` to a row.
template <class V>
struct StateUniforms {
  F<V> width, inverse_width;
  F<V> first, pitch;
  static void describe(auto& s, auto&& port) {
    port(s.width, "states.width");
    port(s.inverse_width, "states.inverse_width");
    port(s.first, "states.first");
    port(s.pitch, "states.pitch");
  }
};
/// Position of the state of sub-pixel `subpixel`, four to a pixel.
template <class V>
F<V> state_of(const I<V>& subpixel, const StateUniforms<V>& of) {
  const DivMod<V> pixel = divmod<V>(to_float(subpixel >> 2U), of.width, of.inverse_width);
  const F<V> column = pixel.remainder + pixel.remainder + to_float(subpixel & 1U);
  const F<V> row = pixel.quotient + pixel.quotient + to_float((subpixel >> 1U) & 1U);
  return of.first + row * of.pitch + column;
}

/// `why`: reasons and round, in their places.
template <class V>
SubpixelRecord<V> state_with(const Vec3<V>& colour, const I<V>& why) {
  const auto channel = [](const F<V>& x) { return to_int(encoded<V>(x) * 65535.0F + 0.5F); };
  return {channel(colour.x) | (channel(colour.y) << 16U), channel(colour.z) | why};
}

/// Leaves for rounds of propagation what an active sub-pixel shows: the mean of its four samples.
struct SettleSubpixels {
  static constexpr std::string_view kName = "settle_subpixels";
  static constexpr std::string_view kMeaning = "listed sub-pixel, its four samples -> its colour and state";
  template <class V>
  struct Ports {
    StateUniforms<V> grid;
    Local<V, WordRecord> active, verdicts;
    Local<V, ColourRecord> colours, shown;
    Local<V, SubpixelRecord> states;
    F<V> first_sample;
    I<V> round;  ///< in its place
    static void describe(auto& p, auto&& port) {
      StateUniforms<V>::describe(p.grid, port);
      port(NAMED(p.active));
      port(NAMED(p.verdicts));
      port(NAMED(p.colours));
      port(NAMED(p.shown));
      port(NAMED(p.states));
      port(NAMED(p.first_sample));
      port(NAMED(p.round));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const I<V> subpixel = at.active.load(item).word;
    const I<V> sample = to_int(at.first_sample + to_float(item << 2U));
    const auto colour = [&](std::uint32_t i) { return clamped_colour<V>(at.colours.load(sample + i).rgb); };
    const Vec3<V> a = colour(0);
    const Vec3<V> b = colour(1);
    const Vec3<V> c = colour(2);
    const Vec3<V> d = colour(3);
    const Vec3<V> mean = ((a + b) + (c + d)) * F<V>(0.25F);
    const I<V> reasons = at.verdicts.load(subpixel).word & kReasonsMask;
    at.shown.store(subpixel, {mean});
    at.states.store(to_int(state_of<V>(subpixel, at.grid)), state_with<V>(mean, (reasons << kReasonsShift) | at.round));
  }
};

/// The same of all sub-pixels as if none was active: the colour at the pixel's centre or, with kBilinear, between the
/// centres around the sub-pixel's own.
template <bool kBilinear>
struct ShowSubpixels {
  static constexpr std::string_view kName = kBilinear ? "show_subpixels_bilinear" : "show_subpixels";
  static constexpr std::string_view kMeaning = "sub-pixel -> its colour and state if it needs no more samples";
  template <class V>
  struct Ports {
    FinishedUniforms<V> finished;
    StateUniforms<V> grid;
    Local<V, ColourRecord> colours, shown;
    Local<V, SubpixelRecord> states;
    static void describe(auto& p, auto&& port) {
      FinishedUniforms<V>::describe(p.finished, port);
      StateUniforms<V>::describe(p.grid, port);
      port(NAMED(p.colours));
      port(NAMED(p.shown));
      port(NAMED(p.states));
    }
  };
  template <class V>
  static void body(const I<V>& item, Ports<V>& at) {
    const DivMod<V> pixel = finished_pixel<V>(to_float(item >> 2U), at.finished);
    const F<V> own = centre_sample<V>(pixel, at.finished);
    Vec3<V> colour = clamped_colour<V>(at.colours.load(to_int(own)).rgb);
    if constexpr (kBilinear) {
      const CornerSteps<V> step =
          corner_steps<V>(pixel, to_float((item << 1U) & 2U) - 1.0F, to_float(item & 2U) - 1.0F, at.finished);
      const Vec3<V> beside = clamped_colour<V>(at.colours.load(to_int(own + step.x)).rgb);
      const Vec3<V> above = clamped_colour<V>(at.colours.load(to_int(own + step.y)).rgb);
      const Vec3<V> corner = clamped_colour<V>(at.colours.load(to_int(own + step.x + step.y)).rgb);
      colour = (colour * F<V>(9.0F) + (beside + above) * F<V>(3.0F) + corner) * F<V>(0.0625F);
    }
    at.shown.store(item, {colour});
    at.states.store(to_int(state_of<V>(item, at.grid)), state_with<V>(colour, I<V>(0U)));
  }
};

}  // namespace kernels
